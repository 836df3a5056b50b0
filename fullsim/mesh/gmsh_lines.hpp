// The lines of a Gmsh file, split at blanks into fields.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace twinchute::fullsim {

/// A reader that goes from line to line. All that it refuses throws SceneError at the line and the column.
class GmshLines {
public:
    static constexpr std::int64_t largest = std::int64_t{1} << 40;  ///< of any whole number in a file

    /// `text` has to outlive it.
    GmshLines(std::string_view text, const std::string& file) : rest_(text), file_(file) {}

    /// Goes to the next line that is not empty; false at the end.
    bool next();
    /// Goes to the next line of a section, which has no end before it.
    void need(std::string_view section);

    int number() const { return number_; }  ///< of the line, from 1
    std::string_view operator[](std::size_t field) const { return fields_[field].text; }
    std::string_view all() const { return all_; }  ///< the whole line, without blanks around it

    void need_fields(std::size_t least, std::string_view what) const;
    std::int64_t whole(std::size_t field, std::string_view what, std::int64_t least,
                       std::int64_t most = largest) const;
    double real(std::size_t field) const;  ///< finite

    [[noreturn]] void refuse(std::string problem, std::string why, std::string hint,
                             std::size_t field = 0) const;
    [[noreturn]] void cut_off(std::string_view section) const;

private:
    struct Field {
        std::string_view text;
        int column;  // from 1
    };
    void split(std::string_view line);

    std::string_view rest_, all_;
    std::string file_;
    int number_ = 0;
    std::vector<Field> fields_;
};

}  // namespace twinchute::fullsim
