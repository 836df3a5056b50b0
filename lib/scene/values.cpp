#include "lib/scene/values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "lib/record/metrics.hpp"
#include "lib/scene/nearest.hpp"
#include "lib/scene/read_scene.hpp"
#include "lib/scene/units.hpp"

namespace twinchute {
namespace {

std::string with_unit(double value, const Key& key) {
    const bool bare = key.record_unit().empty();
    return bare ? fmt::format("{}", value) : fmt::format("{} {}", value, key.unit);
}

}  // namespace

Values::Values(const Document& document, const DocumentKind& kind)
    : kind_(kind),
      file_(document.file),
      design_diameter_(document.design_diameter),
      overridden_(document.overridden),
      predicts_filling_(predicts_filling(document)),
      tables_(document.tables) {
    // In the order of the file, overrides (line 0) first.
    std::vector<const std::pair<const std::string, Entry>*> entries;
    for (const auto& item : document.entries)
        entries.push_back(&item);
    std::ranges::stable_sort(entries, {}, [](const auto* item) {
        return std::pair(item->second.key_place.line, item->second.key_place.column);
    });
    for (const auto* item : entries) {
        const auto& [path, entry] = *item;
        if (entry.key->kind == KeyKind::tolerance)
            read_tolerance(path, entry);
        else
            values_.emplace(path, checked(path, entry));
    }
    // Selectors first, since they decide which other keys are active.
    const auto fill_in_all = [this](bool selectors) {
        for (const Key& key : kind_.keys)
            if (key.is_selector() == selectors) fill_in(key);
    };
    fill_in_all(true);
    for (const auto* item : entries) {
        const auto& [path, entry] = *item;
        require_members_before(path, entry);
        if (entry.key->only_with.empty() || is_active(*entry.key, path)) continue;
        const std::string selector = beside(selector_of(kind_.keys, *entry.key)->path, path);
        refuse(entry.key_place, path, "is not used",
               fmt::format("{} is '{}'", shown_path(selector, kind_.prefix), word(selector)),
               fmt::format("take it out or write {} = \"{}\"", selector.substr(selector.rfind('.') + 1),
                           entry.key->only_with.substr(0, entry.key->only_with.find('|'))));
    }
    fill_in_all(false);
}

void Values::refuse(const SourcePlace& place, std::string_view path, std::string problem, std::string why,
                    std::string hint) const {
    throw SceneError(place, std::string(shown_path(path, kind_.prefix)), std::move(problem), std::move(why),
                     std::move(hint));
}

/// A number in SI, in range.
double Values::checked_number(const std::string& path, const Entry& entry) const {
    const Key& key = *entry.key;
    double value = 0.0;
    if (const auto* text = std::get_if<std::string>(&entry.value)) {
        try {
            value = to_si(*text, key.unit);
        } catch (const UnitError& error) {
            refuse(entry.value_place, path, error.problem(), error.why(), error.suggestion());
        }
    } else if (const auto* whole = std::get_if<std::int64_t>(&entry.value)) {
        value = static_cast<double>(*whole);
    } else {
        value = std::get<double>(entry.value);
    }
    if (!std::isfinite(value))
        refuse(entry.value_place, path, "is not a finite number", "", "write a finite number");
    if (!key.range.contains(value)) {
        const auto* text = std::get_if<std::string>(&entry.value);
        refuse(entry.value_place, path,
               fmt::format("{} is out of range", text ? *text : with_unit(value, key)), allowed_text(key),
               "correct the value or its unit");
    }
    return value;
}

Values::Value Values::checked(const std::string& path, const Entry& entry) const {
    const Key& key = *entry.key;
    Value value{&key, {}, entry.value_place, entry.source, entry.origin, entry.directory};
    const auto* text = std::get_if<std::string>(&entry.value);
    const auto* whole = std::get_if<std::int64_t>(&entry.value);
    const auto wrong_type = [&](std::string_view wanted) {
        const std::string found = text    ? fmt::format("the text '{}'", *text)
                                  : whole ? fmt::format("the number {}", *whole)
                                          : fmt::format("the number {}", std::get<double>(entry.value));
        refuse(entry.value_place, path, fmt::format("{} where {} belongs", found, wanted), "",
               allowed_text(key));
    };
    const std::vector<std::string_view> words = key.choices ? key.choices() : std::vector<std::string_view>{};
    const bool known = text && std::ranges::find(words, *text) != words.end();
    switch (key.kind) {
        case KeyKind::list:
            value.value = checked_list(path, entry);
            break;
        case KeyKind::quantity:
        case KeyKind::quantities:
            value.value = checked_number(path, entry);
            break;
        case KeyKind::quantity_or_word:
            if (known)
                value.value = *text;
            else if (text && text->find_first_of("0123456789") == std::string::npos)
                refuse(entry.value_place, path, fmt::format("unknown word '{}'", *text), "",
                       fmt::format("write {} or a quantity in {}", joined(words), key.unit));
            else
                value.value = checked_number(path, entry);
            break;
        case KeyKind::integer:
            if (!whole) wrong_type("a whole number");
            checked_number(path, entry);
            value.value = *whole;
            break;
        case KeyKind::word:
            if (!text) wrong_type("a word");
            if (!known)
                refuse(entry.value_place, path, fmt::format("unknown word '{}'", *text),
                       fmt::format("known: {}", joined(words)),
                       nearest(*text, words).empty() ? "" : suggest(*text, words));
            value.value = *text;
            break;
        default:
            if (!text) wrong_type("text in quotes");
            if (text->find_first_not_of(" \t\r\n") == std::string::npos)
                refuse(entry.value_place, path, "is empty", "", "give it a name");
            value.value = *text;
    }
    return value;
}

/// Each known, none twice.
std::vector<std::string> Values::checked_list(const std::string& path, const Entry& entry) const {
    const auto& list = std::get<std::vector<std::string>>(entry.value);
    const auto words = entry.key->choices ? entry.key->choices() : std::vector<std::string_view>{};
    for (const std::string& one : list) {
        if (entry.key->choices && std::ranges::count(words, one) == 0)
            refuse(entry.value_place, path, fmt::format("unknown word '{}'", one),
                   fmt::format("known: {}", joined(words)),
                   nearest(one, words).empty() ? "" : suggest(one, words));
        if (std::ranges::count(list, one) > 1)
            refuse(entry.value_place, path, fmt::format("'{}' stands there twice", one), "", "name it once");
    }
    return list;
}

void Values::read_tolerance(const std::string& path, const Entry& entry) {
    const std::string name = path.substr(path.rfind('.') + 1);
    const std::string_view unit = find_judgeable_row(name)->tolerance_unit();
    const auto* text = std::get_if<std::string>(&entry.value);
    if (!text)
        refuse(entry.value_place, path, "a tolerance without a unit",
               "a bare number could be a share or a value", fmt::format("write \"10 %\" or \"1 {}\"", unit));
    Tolerance tolerance;
    tolerance.relative = is_share(*text);
    try {
        tolerance.value = to_si(*text, tolerance.relative ? "1" : unit);
    } catch (const UnitError& error) {
        refuse(entry.value_place, path, error.problem(), error.why(),
               fmt::format("write \"10 %\" or \"1 {}\"", unit));
    }
    if (!entry.key->range.contains(tolerance.value))
        refuse(entry.value_place, path, fmt::format("{} is out of range", *text), allowed_text(*entry.key),
               "write a tolerance that is not negative");
    tolerances_[name] = tolerance;
    values_.emplace(path,
                    Value{entry.key, *text, entry.value_place, entry.source, entry.origin, entry.directory});
}

/// Part of physics that is present, and of the model that is chosen.
bool Values::is_active(const Key& key, std::string_view path) const {
    for (const Key& row : kind_.keys)
        if (row.kind == KeyKind::table && is_below(key.path, row.path) &&
            !tables_.contains(beside(row.path, path)))
            return false;
    if (key.only_with.empty()) return true;
    const auto selector = values_.find(beside(selector_of(kind_.keys, key)->path, path));
    return selector != values_.end() && key.goes_with(std::get<std::string>(selector->second.value));
}

/// Members of a list are counted from 1 without gaps.
void Values::require_members_before(const std::string& path, const Entry& entry) const {
    for (const Key& list : kind_.keys) {
        if (!list.has_members() || !is_below(path, list.path)) continue;
        if (row_path(kind_.keys, path) == path)
            refuse(entry.key_place, path, "does not say which member it is of",
                   fmt::format("{} is a list, of {} here", list.path, count(list.path)),
                   fmt::format("write {}.1{}", list.path, path.substr(list.path.size())));
        const std::size_t begin = list.path.size() + 1;
        const std::string number = path.substr(begin, path.find('.', begin) - begin);
        const int members = count(list.path);
        if (plain_number(number) > members)
            refuse(entry.key_place, path, fmt::format("there is no member {} of {}", number, list.path),
                   fmt::format("it has {}", members), "count from 1, without gaps");
    }
}

/// Exactly one of a key and its alternative.
void Values::require_alternatives(const Key& key, const std::string& path) const {
    const auto one = values_.find(path);
    for (const std::string_view row : words_of(key.instead_of))
        if (const std::string other = beside(row, path); one != values_.end() && values_.contains(other))
            refuse(one->second.place, path, fmt::format("stands beside {}", shown_path(other, kind_.prefix)),
                   "both say the same thing", "keep exactly one of the two");
}

/// The table that a key should stand in, or the top of the file.
SourcePlace Values::place_of_absent(std::string_view path) const {
    for (std::string table(path); table.find('.') != std::string::npos;) {
        table.resize(table.rfind('.'));
        if (const auto found = tables_.find(table); found != tables_.end()) return found->second;
    }
    return {file_, 1, 1};
}

/// The default of a key that is absent, or a complaint when there is none; of a list's key, for each member.
void Values::fill_in(const Key& key) {
    if (key.has_members()) return;
    const auto list = std::ranges::find_if(kind_.keys, [&](const Key& row) {
        return row.kind == KeyKind::tables && is_below(key.path, row.path);
    });
    if (list == kind_.keys.end()) return fill_in(key, std::string(key.path));
    for (int i = 1; i <= count(list->path); ++i)
        fill_in(key, beside(key.path, fmt::format("{}.{}.", list->path, i)));
}

void Values::fill_in(const Key& key, const std::string& path) {
    if (!key.instead_of.empty()) require_alternatives(key, path);
    if (key.kind == KeyKind::table) {
        if (key.need == KeyNeed::required && !tables_.contains(path))
            refuse({file_, 1, 1}, path, "is missing", std::string(key.meaning),
                   fmt::format("add a [[{}]] table", path));
        return;
    }
    if (values_.contains(path) || !is_active(key, path)) return;
    if (predicts_filling_ && prescribes_filling(path)) return;
    std::vector<std::string> others;
    for (const std::string_view row : words_of(key.instead_of))
        others.push_back(beside(row, path));
    if (std::ranges::any_of(others, [this](const std::string& other) { return values_.contains(other); }))
        return;
    if (key.need == KeyNeed::optional) return;
    // An open canopy fills no more.
    if (path == "parachute.fill_time.n" && word("parachute.deploy.by") == "inflated") return;
    if (key.need == KeyNeed::required) {
        const std::string unit = key.record_unit().empty() ? "" : fmt::format(", in {}", key.unit);
        refuse(place_of_absent(path), path, "is missing", fmt::format("{}{}", key.meaning, unit),
               key.instead_of.empty()
                   ? allowed_text(key)
                   : fmt::format("give it or {}", shown_path(others.front(), kind_.prefix)));
    }
    Value value;
    value.key = &key;
    value.place = place_of_absent(path);
    value.source = key.source;
    if (key.kind == KeyKind::integer)
        value.value = static_cast<std::int64_t>(plain_number(key.fallback));
    else if (key.kind == KeyKind::quantity)
        value.value = plain_number(key.fallback);
    else if (key.kind == KeyKind::list)
        value.value = std::vector<std::string>{std::string(key.fallback)};
    else
        value.value = std::string(key.fallback);
    values_.emplace(path, std::move(value));
}

const Values::Value& Values::at(std::string_view path) const {
    return values_.at(std::string(path));  // throws out_of_range for a key that is not effective
}

double Values::number(std::string_view path) const {
    return std::get<double>(at(path).value);
}
std::vector<double> Values::numbers(std::string_view path) const {
    std::vector<double> all;
    for (int i = 1; i <= count(path); ++i)
        all.push_back(number(fmt::format("{}.{}", path, i)));
    return all;
}
const std::string& Values::word(std::string_view path) const {
    return std::get<std::string>(at(path).value);
}

const std::vector<std::string>& Values::list(std::string_view path) const {
    return std::get<std::vector<std::string>>(at(path).value);
}

bool Values::given(std::string_view path) const {
    const auto found = values_.find(path);
    return found != values_.end() && found->second.origin != InputOrigin::fallback;
}

bool Values::is_designed(std::string_view path) const {
    const auto found = values_.find(path);
    return found != values_.end() && found->second.origin == InputOrigin::design;
}

bool Values::has_table(std::string_view path) const {
    return tables_.contains(std::string(path));
}

int Values::count(std::string_view path) const {
    const auto has = [&](int i) {
        const std::string member = fmt::format("{}.{}", path, i);
        return tables_.contains(member) || values_.contains(member);
    };
    int found = 0;
    while (has(found + 1))
        ++found;
    return found;
}

SourcePlace Values::place(std::string_view path) const {
    const auto found = values_.find(path);
    return found == values_.end() ? place_of_absent(path) : found->second.place;
}

std::string Values::source_of(const Value& value) {
    // A default stands where its table does.
    if (!is_override(value.place.file) || value.origin == InputOrigin::fallback) return value.source;
    return std::string(command_line_source) + (value.source.empty() ? "" : ": " + value.source);
}

std::vector<Input> Values::inputs() const {
    std::vector<Input> list;
    for (const Key& row : kind_.keys)
        for (const auto& [path, value] : values_) {
            if (value.key->path != row.path || row.user == KeyUser::campaign) continue;
            Input input{path, {}, std::string(row.record_unit()), value.origin, source_of(value)};
            if (const auto* number = std::get_if<double>(&value.value)) {
                input.value = *number;
            } else if (const auto* whole = std::get_if<std::int64_t>(&value.value)) {
                input.value = static_cast<double>(*whole);
            } else {
                const auto* texts = std::get_if<std::vector<std::string>>(&value.value);
                input.value =
                    texts ? fmt::format("{}", fmt::join(*texts, ", ")) : std::get<std::string>(value.value);
                input.unit.clear();
            }
            list.push_back(std::move(input));
        }
    return list;
}

}  // namespace twinchute
