// The keys of a document with their values checked: units, ranges, words, what must be there.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lib/record/run_record.hpp"
#include "lib/scene/document.hpp"
#include "lib/scene/scene.hpp"

namespace twinchute {

/// Every effective key of a scene or of a material file.
class Values {
public:
    /// Throws SceneError for the first key, in the order of the file, that is wrong, then for one
    /// that is missing.
    Values(const Document& document, const DocumentKind& kind);

    // The value of a key that is effective; asking for another is a programmer's mistake.
    double number(std::string_view path) const;                ///< in SI
    std::vector<double> numbers(std::string_view path) const;  ///< of a list; empty where it is absent
    const std::string& word(std::string_view path) const;      ///< a word, text or name of a file

    const std::vector<std::string>& list(std::string_view path) const;

    /// Puts the effective keys below `table` where the table of keys binds them in an object of this kind.
    template <class Object>
    void read_into(Object& object, std::string_view table = "") const {
        for (const auto& [path, value] : values_) {
            const auto* binding = std::get_if<BindingOf<Object>>(&value.key->binding);
            if (!binding || !binding->set || !is_below(path, table)) continue;
            if (value.key->kind != KeyKind::quantities)
                binding->set(object, value.value);
            else if (path.ends_with(".1"))
                binding->set(object, numbers(value.key->path));
        }
    }

    /// Given, by the scene or a design: not a default.
    bool given(std::string_view path) const;
    /// The table of optional physics is present.
    bool has_table(std::string_view path) const;
    /// From a design file, or from a type's.
    bool is_designed(std::string_view path) const;
    /// [m] D0 as the design has it, where the scene gives its own.
    std::optional<double> design_diameter() const { return design_diameter_; }
    /// Keys of a design or type that a predicted filling stands in place of.
    const std::vector<std::string>& overridden() const { return overridden_; }
    /// Members of a list, "path.1" and so on; 0 when it is absent.
    int count(std::string_view path) const;

    /// Where a key was given; for a default the table it would stand in, or the top of the file.
    SourcePlace place(std::string_view path) const;
    /// Where the files that a key names are looked for first.
    const std::filesystem::path& directory(std::string_view path) const { return at(path).directory; }

    const std::map<std::string, Tolerance>& tolerances() const { return tolerances_; }

    /// Inputs as the record lists them, in the order of the table of keys.
    std::vector<Input> inputs() const;

private:
    struct Value {
        const Key* key = nullptr;
        KeyValue value;
        SourcePlace place;
        std::string source;
        InputOrigin origin = InputOrigin::fallback;
        std::filesystem::path directory;
    };

    static std::string source_of(const Value& value);
    Value checked(const std::string& path, const Entry& entry) const;
    double checked_number(const std::string& path, const Entry& entry) const;
    std::vector<std::string> checked_list(const std::string& path, const Entry& entry) const;
    void read_tolerance(const std::string& path, const Entry& entry);
    void require_members_before(const std::string& path, const Entry& entry) const;
    void require_alternatives(const Key& key, const std::string& path) const;
    void fill_in(const Key& key);
    void fill_in(const Key& key, const std::string& path);
    SourcePlace place_of_absent(std::string_view path) const;
    bool is_active(const Key& key, std::string_view path) const;
    const Value& at(std::string_view path) const;
    [[noreturn]] void refuse(const SourcePlace& place, std::string_view path, std::string problem,
                             std::string why, std::string hint) const;

    DocumentKind kind_;
    std::string file_;
    std::optional<double> design_diameter_;
    std::vector<std::string> overridden_;
    bool predicts_filling_ = false;
    std::map<std::string, SourcePlace> tables_;
    std::map<std::string, Value, std::less<>> values_;
    std::map<std::string, Tolerance> tolerances_;
};

}  // namespace twinchute
