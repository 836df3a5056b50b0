#include "fullsim/mesh/gmsh_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <utility>

#include "lib/scene/scene_error.hpp"

namespace twinchute::fullsim {
namespace {

constexpr std::string_view blanks = " \t\r";

std::string_view shown(std::string_view text) {
    return text.substr(0, 40);
}

/// Reads the whole text as one number.
template <class Number>
std::errc parse(std::string_view text, Number& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{}) return error;
    return end == text.data() + text.size() ? std::errc{} : std::errc::invalid_argument;
}

}  // namespace

bool GmshLines::next() {
    while (!rest_.empty()) {
        const std::size_t feed = std::min(rest_.find('\n'), rest_.size());
        split(rest_.substr(0, feed));
        rest_.remove_prefix(std::min(feed + 1, rest_.size()));
        ++number_;
        if (!fields_.empty()) return true;
    }
    fields_.clear();
    return false;
}

void GmshLines::need(std::string_view section) {
    if (!next()) cut_off(section);
    if (fields_.front().text.starts_with("$End"))
        refuse(fmt::format("${} ends too early", section), "it has fewer lines than it says",
               "export it again");
}

void GmshLines::need_fields(std::size_t least, std::string_view what) const {
    if (fields_.size() < least)
        refuse(fmt::format("{} numbers where {} has at least {}", fields_.size(), what, least),
               "the line is cut off", "export it again", fields_.size());
}

std::int64_t GmshLines::whole(std::size_t field, std::string_view what, std::int64_t least,
                              std::int64_t most) const {
    std::int64_t value = 0;
    if (parse((*this)[field], value) != std::errc{} || value < least || value > most)
        refuse(fmt::format("'{}' is not a {}", shown((*this)[field]), what), fmt::format("{} or more", least),
               "export it again", field);
    return value;
}

double GmshLines::real(std::size_t field) const {
    double value = 0.0;
    const std::errc error = parse((*this)[field], value);
    if (error != std::errc{} || !std::isfinite(value))
        refuse(fmt::format("'{}' is not a {}", shown((*this)[field]),
                           error == std::errc::invalid_argument ? "number" : "finite number"),
               "", "correct the mesh", field);
    return value;
}

void GmshLines::refuse(std::string problem, std::string why, std::string hint, std::size_t field) const {
    const int column = field < fields_.size() ? fields_[field].column : 1;
    throw SceneError({file_, std::max(1, number_), column}, "", std::move(problem), std::move(why),
                     std::move(hint));
}

void GmshLines::cut_off(std::string_view section) const {
    refuse(fmt::format("the file ends inside ${}", section), "it was cut off", "export it again");
}

void GmshLines::split(std::string_view line) {
    fields_.clear();
    all_ = {};
    std::size_t end = 0;
    for (std::size_t begin; (begin = line.find_first_not_of(blanks, end)) != line.npos;) {
        end = std::min(line.find_first_of(blanks, begin), line.size());
        fields_.push_back({line.substr(begin, end - begin), static_cast<int>(begin) + 1});
    }
    if (fields_.empty()) return;
    const std::size_t first = static_cast<std::size_t>(fields_.front().column) - 1;
    all_ = line.substr(first, end - first);
}

}  // namespace twinchute::fullsim
