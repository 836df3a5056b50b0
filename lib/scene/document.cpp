#include "lib/scene/document.hpp"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "lib/record/metrics.hpp"
#include "lib/scene/data_files.hpp"
#include "lib/scene/nearest.hpp"

namespace twinchute {

bool is_override(std::string_view file) {
    return file.starts_with("--") &&
           std::ranges::all_of(file, [](char c) { return c == '-' || (c >= 'a' && c <= 'z'); });
}

namespace {

constexpr std::size_t max_cases = 1000;
constexpr std::size_t max_members = 999;  // of a list: row_path() knows three digits
constexpr std::size_t max_parachutes = 20;

SourcePlace place_of(const std::string& file, const toml::source_region& region) {
    if (is_override(file)) return {file, 0, 0};
    return {file, static_cast<int>(region.begin.line), static_cast<int>(region.begin.column)};
}

std::string_view parent_of(std::string_view path) {
    const auto dot = path.rfind('.');
    return dot == std::string_view::npos ? std::string_view{} : path.substr(0, dot);
}

std::string_view last_of(std::string_view path) {
    return path.substr(path.rfind('.') + 1);
}

std::string_view type_name(const toml::node& node) {
    switch (node.type()) {
        case toml::node_type::table:
            return "a table";
        case toml::node_type::array:
            return "an array";
        case toml::node_type::string:
            return "text";
        case toml::node_type::integer:
            return "a whole number";
        case toml::node_type::floating_point:
            return "a number";
        case toml::node_type::boolean:
            return "true or false";
        default:
            return "a date or time";
    }
}

std::string_view wanted_name(const Key& key) {
    switch (key.kind) {
        case KeyKind::quantity:
            return key.unit == "1" ? "a number" : "a number in SI or a string with a unit";
        case KeyKind::quantity_or_word:
            return "a word or a quantity";
        case KeyKind::integer:
            return "a whole number";
        case KeyKind::table:
        case KeyKind::tolerance:
            return "a table";
        case KeyKind::list:
            return "a list of texts in quotes";
        default:
            return "text in quotes";
    }
}

bool is_same_name(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
    return std::ranges::equal(a, b, {}, lower, lower);
}

/// Walks the parsed tree. Children are visited in the order of the file, so that the first
/// mistake in the file is the one reported.
class Walk {
public:
    /// `overriding`: what is read will be laid over a scene, as --set and the sets of cases are.
    Walk(Document& document, const DocumentKind& kind, bool overriding = false)
        : document_(document), kind_(kind), overriding_(overriding) {}

    void table(const toml::table& node, const std::string& prefix) {
        std::vector<std::pair<const toml::key*, const toml::node*>> children;
        for (const auto& [key, child] : node)
            children.emplace_back(&key, &child);
        std::ranges::stable_sort(children, {}, [](const auto& child) {
            const auto& begin = child.first->source().begin;
            return std::pair(begin.line, begin.column);
        });
        for (const auto& [key, child] : children)
            visit(*key, *child, prefix + std::string(key->str()));
    }

    /// { "release.altitude" = "60 m" }: here a dot in a quoted key is a path.
    void assignments(const toml::table& node) {
        dots_are_paths_ = true;
        table(node, "");
    }

private:
    [[noreturn]] void refuse(const SourcePlace& place, std::string_view path, std::string problem,
                             std::string why, std::string hint) const {
        throw SceneError(place, std::string(shown_path(path, kind_.prefix)), std::move(problem),
                         std::move(why), std::move(hint));
    }

    bool is_branch(std::string_view full_path) const {
        const std::string path = row_path(kind_.keys, full_path);
        return std::ranges::any_of(kind_.keys, [&](const Key& row) {
            return row.path.size() > path.size() && row.path.starts_with(path) &&
                   row.path[path.size()] == '.';
        });
    }

    void visit(const toml::key& name, const toml::node& node, const std::string& path) {
        visit(name, node, path, dots_are_paths_ && path == name.str());
    }

    /// is_path: the name is a whole path with its dots.
    void visit(const toml::key& name, const toml::node& node, const std::string& path, bool is_path) {
        const SourcePlace place = place_of(document_.file, name.source());
        // A dot inside a quoted key would look like a path.
        const bool plain = (is_path || name.str().find('.') == std::string_view::npos) && !name.str().empty();
        const Key* key = plain ? find_key(kind_.keys, path) : nullptr;
        if (plain && !key)
            if (const Key* successor = find_successor(kind_.keys, path)) {
                warn_of_retired(path, beside(successor->path, path), place);
                return visit(name, node, beside(successor->path, path), is_path);
            }
        if (key && !key->formerly.empty() && document_.entries.contains(path))
            refuse(place, path, "is given twice", fmt::format("{} is its retired name", retired_names(*key)),
                   fmt::format("keep {} alone", last_of(path)));
        if (overriding_ && (path == "base" || path == "case" || path.starts_with("case.")))
            refuse(place, path, "cannot be overridden", "", "write it at the top of a scene");
        if (is_path)
            for (std::string_view table = parent_of(path); key && !table.empty(); table = parent_of(table))
                document_.tables.insert_or_assign(std::string(table), place);
        const Key* above = plain && is_path ? find_key(kind_.keys, parent_of(path)) : nullptr;
        if (above && above->kind == KeyKind::tolerance) {
            tolerance(*above, node, path, place);
        } else if (key && path == "case") {
            cases(node, place);
        } else if (key && key->kind == KeyKind::tolerance) {
            tolerances(*key, node, path, place);
        } else if (key && key->has_members() && key->path == path) {
            list(*key, node, path, place);
        } else if (key && key->kind != KeyKind::table && key->kind != KeyKind::tables) {
            document_.entries.insert_or_assign(path, leaf(*key, node, path, place));
        } else if (plain && (key || is_branch(path))) {
            branch(node, path, place);
        } else if (plain && overriding_ && path.starts_with("parachute.")) {
            parachute_by_name(name, node, path, is_path);
        } else {
            refuse(place, path, "unknown key", "", plain ? suggestion(path) : "write keys without quotes");
        }
    }

    /// In words.
    std::string retired_names(const Key& key) const {
        std::vector<std::string_view> shown;
        for (const std::string_view path : words_of(key.formerly))
            shown.push_back(shown_path(path, kind_.prefix));
        return fmt::format("{}", fmt::join(shown, " or "));
    }

    void warn_of_retired(std::string_view path, std::string_view now, const SourcePlace& place) {
        const std::string file = std::filesystem::path(place.file).filename().string();
        document_.warnings.push_back(
            {fmt::format("key '{}' is now '{}'", shown_path(path, kind_.prefix),
                         shown_path(now, kind_.prefix)),
             place.line > 0 ? fmt::format("line {} of {}", place.line, file) : place.file,
             "rename it: the next version of the schema refuses the old name"});
    }

    /// The key that a value in place of its table is short for: atmosphere = "us76" for { model = "us76" }.
    static std::string short_for(const std::string& path, const toml::node& node) {
        const toml::table* table = node.as_table();
        const bool is_quantity = node.is_number() || node.is_string() || (table && table->contains("value"));
        if (path == "fabric.permeability" && is_quantity) return path + ".speed";
        const bool is_choice = path == "environment.atmosphere" || path == "parachute.filling";
        return is_choice && node.is_string() ? path + ".model" : "";
    }

    void branch(const toml::node& node, const std::string& path, const SourcePlace& place) {
        if (path == "parachute" && !overriding_) return parachutes(node, place);
        if (const std::string key = short_for(path, node); !key.empty()) {
            document_.entries.insert_or_assign(key, leaf(*find_key(kind_.keys, key), node, key, place));
            return;
        }
        const toml::table* inner = node.as_table();
        if (!inner) {
            const SourcePlace value = place_of(document_.file, node.source());
            const std::string_view written = shown_path(path, kind_.prefix);
            refuse(value, path, fmt::format("{} where a table belongs", type_name(node)), "",
                   fmt::format("write [{}] with its keys below, or {} = {{ ... }}", written, last_of(path)));
        }
        document_.tables.insert_or_assign(path, place);
        table(*inner, path + ".");
    }

    /// Its members as "path.1" and so on. One that is laid over a scene may name a single member instead.
    void list(const Key& key, const toml::node& node, const std::string& path, const SourcePlace& place) {
        const toml::array* array = node.as_array();
        if (overriding_ && node.is_table()) return table(*node.as_table(), path + ".");
        const bool of_tables = key.kind == KeyKind::tables;
        if (!array || array->empty())
            refuse(place, path, fmt::format("{} where a list belongs", type_name(node)), "",
                   of_tables ? fmt::format("write [[{}]] with two brackets", shown_path(path, kind_.prefix))
                             : fmt::format("write {} = [\"0 {}\", ...]", last_of(path), key.unit));
        if (array->size() > max_members)
            refuse(place, path, fmt::format("more than {} members", max_members), "", "shorten the list");
        document_.lists.insert(path);
        for (std::size_t i = 0; i < array->size(); ++i) {
            const toml::node& item = (*array)[i];
            const std::string member = fmt::format("{}.{}", path, i + 1);
            const SourcePlace where = place_of(document_.file, item.source());
            if (!of_tables)
                document_.entries.insert_or_assign(member, leaf(key, item, member, where));
            else
                branch(item, member, where);
        }
    }

    void parachutes(const toml::node& node, const SourcePlace& place) {
        const toml::array* array = node.as_array();
        if (!array || array->empty() || !array->front().is_table())
            refuse(place, "parachute", "is not a list of tables", "a scene may have several",
                   "write [[parachute]] with two brackets");
        if (array->size() > max_parachutes)
            refuse(place_of(document_.file, (*array)[max_parachutes].source()), "parachute",
                   fmt::format("more than {} parachutes", max_parachutes), "", "give alike ones a count");
        for (const toml::node& item : *array) {
            const SourcePlace where = place_of(document_.file, item.source());
            const bool first = &item == &array->front();
            if (!item.is_table())
                refuse(where, "parachute", fmt::format("{} where a table belongs", type_name(item)), "",
                       "write [[parachute]] with its keys below");
            Document& to = first ? document_ : document_.parachutes.emplace_back();
            to.file = document_.file;
            to.tables.insert_or_assign("parachute", where);
            Walk(to, kind_).table(*item.as_table(), "parachute.");
        }
    }

    /// "parachute.drogue.mass": keys of one of several parachutes, by name or number.
    void parachute_by_name(const toml::key& key, const toml::node& node, const std::string& path,
                           bool is_path) {
        constexpr std::string_view head = "parachute.";
        const std::string_view below = std::string_view(path).substr(head.size());
        const std::string_view name = below.substr(0, below.find('.'));
        const SourcePlace place = place_of(document_.file, key.source());
        if (name.size() == below.size() && !node.is_table())
            refuse(place, path, "unknown key", "", suggestion(path));
        Document& to = document_.named_parachutes[std::string(name)];
        to.file = document_.file;
        to.tables.insert_or_assign("parachute", place);
        Walk walk(to, kind_, true);
        if (name.size() == below.size())
            walk.table(*node.as_table(), std::string(head));
        else
            walk.visit(key, node, std::string(head) + std::string(below.substr(name.size() + 1)), is_path);
    }

    void cases(const toml::node& node, const SourcePlace& place) {
        const toml::array* array = node.as_array();
        if (!array || array->empty())
            refuse(place, "case", "is not a list of tables", "", "write [[case]] with two brackets");
        for (const toml::node& item : *array) {
            const SourcePlace where = place_of(document_.file, item.source());
            if (!item.is_table())
                refuse(where, "case", fmt::format("{} where a table belongs", type_name(item)), "",
                       "write [[case]] with name and set below");
            if (document_.cases.size() == max_cases)
                refuse(where, "case", fmt::format("more than {} cases", max_cases), "every one is a run",
                       "split the series");
            document_.cases.push_back(one_case(*item.as_table(), where));
        }
    }

    DocumentCase one_case(const toml::table& node, const SourcePlace& place) {
        for (const auto& [key, child] : node)
            if (key.str() != "name" && key.str() != "set")
                refuse(place_of(document_.file, key.source()), "case." + std::string(key.str()),
                       "unknown key", "", suggest(key.str(), {"name", "set"}));
        const toml::node* name = node.get("name");
        if (!name) refuse(place, "case.name", "is missing", "results are kept by it", "add name = \"...\"");
        DocumentCase found{name->value_exact<std::string>().value_or(""), place, {}};
        const SourcePlace name_place = place_of(document_.file, name->source());
        if (!name->is_string())
            refuse(name_place, "case.name", fmt::format("{} where text belongs", type_name(*name)), "",
                   "write it in quotes");
        if (found.name.empty() || file_stem_of(found.name) != found.name)
            refuse(name_place, "case.name", fmt::format("'{}' is not fit for a directory", found.name),
                   "letters, digits, '-', '_' and '.', at most 80 of them, no '.' or '-' at an end",
                   fmt::format("write e.g. \"{}\"", file_stem_of(found.name)));
        for (const DocumentCase& other : document_.cases)
            if (is_same_name(other.name, found.name))
                refuse(name_place, "case.name",
                       fmt::format("'{}' stands in line {} too", other.name, other.place.line),
                       "results are kept by name, and not every system tells capitals apart",
                       "name each case once");
        found.set.file = document_.file;
        const toml::node* set = node.get("set");
        if (!set) return found;
        if (!set->is_table())
            refuse(place_of(document_.file, set->source()), "case.set",
                   fmt::format("{} where a table belongs", type_name(*set)), "",
                   "write set = { \"payload.mass\" = \"80 kg\" }");
        try {
            Walk(found.set, kind_, true).assignments(*set->as_table());
        } catch (const SceneError& error) {
            throw error.within(case_title(found.name));
        }
        imply_models(found.set);
        return found;
    }

    void tolerances(const Key& key, const toml::node& node, const std::string& path,
                    const SourcePlace& place) {
        const toml::table* inner = node.as_table();
        if (!inner)
            refuse(place, path, fmt::format("{} where a table belongs", type_name(node)), "",
                   "name a metric, e.g. compare.tolerance.peak_force = \"10 %\"");
        document_.tables.insert_or_assign(path, place);
        for (const auto& [name, child] : *inner)
            tolerance(key, child, path + "." + std::string(name.str()),
                      place_of(document_.file, name.source()));
    }

    void tolerance(const Key& key, const toml::node& node, const std::string& path,
                   const SourcePlace& place) {
        const std::string_view name = std::string_view(path).substr(key.path.size() + 1);
        std::vector<std::string_view> names;
        for (const MetricRow& metric : judgeable_rows())
            names.push_back(metric.name);
        if (!find_judgeable_row(name)) refuse(place, path, "unknown metric", "", suggest(name, names));
        document_.entries.insert_or_assign(path, leaf(key, node, path, place));
    }

    Entry leaf(const Key& key, const toml::node& node, const std::string& path, const SourcePlace& place) {
        Entry entry{&key, {},           place,          place_of(document_.file, node.source()),
                    {},   kind_.origin, kind_.directory};
        const toml::node* value = &node;
        if (const toml::table* annotated = node.as_table()) {
            value = annotated->get("value");
            if (!value)
                refuse(entry.value_place, path, "a table without a value", "",
                       "write { value = ..., source = \"...\" }");
            entry.value_place = place_of(document_.file, value->source());
            entry.source = annotation(*annotated, path);
        }
        if (key.kind == KeyKind::list) {
            entry.value = list_of(key, *value, path, entry.value_place);
        } else if (const auto text = value->value_exact<std::string>()) {
            entry.value = *text;
        } else if (const auto whole = value->value_exact<std::int64_t>()) {
            entry.value = *whole;
        } else if (const auto number = value->value_exact<double>()) {
            entry.value = *number;
        } else {
            refuse(entry.value_place, path,
                   fmt::format("{} where {} belongs", type_name(*value), wanted_name(key)), "",
                   allowed_text(key));
        }
        return entry;
    }

    /// Texts, or a single one.
    std::vector<std::string> list_of(const Key& key, const toml::node& node, const std::string& path,
                                     const SourcePlace& place) const {
        const auto text_of = [&](const toml::node& item) {
            const auto text = item.value_exact<std::string>();
            if (!text)
                refuse(place, path, fmt::format("{} where {} belongs", type_name(item), wanted_name(key)), "",
                       allowed_text(key));
            return *text;
        };
        const toml::array* array = node.as_array();
        if (!array) return {text_of(node)};
        if (array->empty()) refuse(place, path, "is an empty list", "", allowed_text(key));
        std::vector<std::string> texts;
        for (const toml::node& item : *array)
            texts.push_back(text_of(item));
        return texts;
    }

    /// source and grade of { value = ..., source = "...", grade = "S" }.
    std::string annotation(const toml::table& node, const std::string& path) {
        std::string source, grade;
        for (const auto& [name, child] : node) {
            if (name.str() == "value") continue;
            const SourcePlace place = place_of(document_.file, name.source());
            const std::string child_path = path + "." + std::string(name.str());
            if (name.str() != "source" && name.str() != "grade")
                refuse(place, child_path, "unknown key", "", "a value may carry value, source and grade");
            const auto text = child.value_exact<std::string>();
            if (!text)
                refuse(place, child_path, fmt::format("{} where text belongs", type_name(child)), "", "");
            (name.str() == "source" ? source : grade) = *text;
        }
        return grade.empty() ? source : fmt::format("{} [grade {}]", source, grade);
    }

    /// Suggests the same name in another table, else the nearest here, else all names here.
    std::string suggestion(std::string_view full_path) const {
        const std::string path = row_path(kind_.keys, full_path);
        const std::string start(path.substr(0, path.size() - last_of(path).size()));
        std::vector<std::string_view> siblings, elsewhere;
        for (const Key& row : kind_.keys) {
            if (last_of(row.path) == last_of(path)) elsewhere.push_back(shown_path(row.path, kind_.prefix));
            if (!row.path.starts_with(start)) continue;
            const std::string_view rest = row.path.substr(start.size());
            const std::string_view sibling = rest.substr(0, rest.find('.'));
            if (siblings.empty() || siblings.back() != sibling) siblings.push_back(sibling);
        }
        if (!elsewhere.empty() && elsewhere.size() <= 3)
            return fmt::format("did you mean '{}'?", fmt::join(elsewhere, "' or '"));
        const std::string_view near = nearest(last_of(path), siblings);
        if (near.empty()) return suggest(last_of(path), siblings);
        return fmt::format("did you mean '{}'?", shown_path(start + std::string(near), kind_.prefix));
    }

    Document& document_;
    const DocumentKind& kind_;
    bool overriding_;
    bool dots_are_paths_ = false;
};

toml::table parsed(std::string_view text, const std::string& file, const std::string& key) {
    try {
        return toml::parse(text, std::string_view(file));
    } catch (const toml::parse_error& error) {
        const std::string why(error.description());
        const bool bare = why.find("expected a comment or whitespace, saw") != std::string::npos;
        throw SceneError(place_of(file, error.source()), key, "not valid TOML", why,
                         bare          ? "put a value with a unit in quotes, e.g. \"5 kg\""
                         : key.empty() ? "mend this line"
                                       : "write key=value with the value in TOML");
    }
}

}  // namespace

namespace {

Document read_anew(std::string_view text, const std::string& file, const DocumentKind& kind) {
    const toml::table root = parsed(text, file, "");
    // A cord where a fabric is wanted would otherwise be refused for one of its other keys.
    const auto word = root["kind"].value<std::string>();
    const Key* row = find_key(kind.keys, kind.prefix + "kind");
    if (row && word && *word != row->choices().front())
        throw SceneError(place_of(file, root.get("kind")->source()), "kind",
                         fmt::format("'{}' where {} is wanted", *word, row->choices().front()), "",
                         fmt::format("name another file for {}", kind.asked_by));
    Document document;
    document.file = file;
    Walk(document, kind).table(root, kind.prefix);
    imply_models(document);
    return document;
}

/// Documents that were read more than once: campaigns and pages read a scene again and again, with the same
/// design and materials each time, and parsing is half of that.
class KnownDocuments {
public:
    Document read(std::string_view text, const std::string& file, const DocumentKind& kind) {
        const Origin origin{file, kind.prefix, kind.asked_by, kind.directory, kind.keys.data(), kind.origin};
        if (const auto known = find(text, origin)) return *known;
        Document document = read_anew(text, file, kind);
        keep(text, origin, document);
        return document;
    }

private:
    /// All that a document depends on beside its text.
    struct Origin {
        std::string file, prefix, asked_by;
        std::filesystem::path directory;
        const Key* keys;
        InputOrigin origin;
        bool operator==(const Origin&) const = default;
    };
    struct Known {
        std::string text;
        Origin origin;
        std::shared_ptr<const Document> document;  ///< null: it was read once
    };
    static constexpr std::size_t most = 16, largest_text = 64 << 10;  // [bytes]

    std::shared_ptr<const Document> find(std::string_view text, const Origin& origin) {
        const std::lock_guard guard(lock_);
        const auto known = place_of_known(text, origin);
        return known == known_.end() ? nullptr : known->document;
    }

    void keep(std::string_view text, const Origin& origin, const Document& document) {
        if (text.size() > largest_text) return;
        const std::lock_guard guard(lock_);
        const auto known = place_of_known(text, origin);
        if (known != known_.end()) {
            if (!known->document) known->document = std::make_shared<const Document>(document);
            return;
        }
        if (known_.size() == most) known_.erase(known_.begin());
        known_.push_back({std::string(text), origin, nullptr});
    }

    std::vector<Known>::iterator place_of_known(std::string_view text, const Origin& origin) {
        return std::ranges::find_if(
            known_, [&](const Known& one) { return one.text == text && one.origin == origin; });
    }

    std::mutex lock_;
    std::vector<Known> known_;  // the oldest first
};

}  // namespace

Document read_document(std::string_view text, const std::string& file, const DocumentKind& kind) {
    static KnownDocuments known;
    return known.read(text, file, kind);
}

Document read_override(const std::string& override_text, const DocumentKind& kind) {
    const std::string option = override_text.substr(0, override_text.find(' '));
    const bool named = is_override(option) && option.size() < override_text.size();
    const SourcePlace place{named ? option : "--set", 0, 0};
    const std::string assignment = named ? override_text.substr(option.size() + 1) : override_text;
    const auto equals = assignment.find('=');
    std::string key = assignment.substr(0, equals), value;
    while (key.ends_with(' '))
        key.pop_back();
    if (equals != std::string::npos) value = assignment.substr(equals + 1);
    value.erase(0, value.find_first_not_of(' '));
    const bool plain = !key.empty() && std::ranges::all_of(key, [](char c) {
        return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
               c == '-' || c == '.';
    });
    if (equals == std::string::npos || !plain || value.empty() ||
        value.find_first_of("\r\n") != std::string::npos)
        throw SceneError(place, "", fmt::format("'{}' is not key=value", assignment), "",
                         "write e.g. --set payload.mass='150 kg'");

    toml::table root;
    if (std::string_view("\"'{[").find(value.front()) != std::string_view::npos) {
        root = parsed(key + " = " + value, place.file, key);
    } else {
        try {
            root = toml::parse(key + " = " + value);
        } catch (const toml::parse_error&) {  // as typed in a shell: payload.mass=150 kg
            root = parsed(key + " = ''", place.file, key);
            toml::node* node = &root;
            while (toml::table* table = node->as_table())
                node = &table->begin()->second;
            *node->as_string() = value;
        }
    }
    Document document;
    document.file = place.file;
    Walk(document, kind, true).table(root, kind.prefix);
    imply_models(document);
    return document;
}

}  // namespace twinchute
