// summary.json back into a record.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <utility>

#include "lib/record/record_parts.hpp"

namespace twinchute {
namespace {

using Json = nlohmann::ordered_json;

// Looking up a key walks the object, so that a large one costs the square of its size.
constexpr std::size_t most_keys = 2048;
constexpr int deepest = 32;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// Line and column of a byte, which the parser counts from 1.
RecordPlace place_of(std::string_view text, std::size_t byte, const std::string& file) {
    const std::string_view before = text.substr(0, std::min(text.size(), byte == 0 ? 0 : byte - 1));
    const std::size_t feed = before.rfind('\n');
    return {file, static_cast<int>(std::ranges::count(before, '\n')) + 1,
            static_cast<int>(before.size() - (feed == before.npos ? 0 : feed + 1)) + 1};
}

/// A foreign word in a message: short, and no control characters.
std::string shown(std::string_view text, std::size_t longest = 40) {
    std::string clean(text.substr(0, longest));
    std::ranges::replace_if(
        clean, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
    return text.size() > longest ? clean + "..." : clean;
}

/// Keeps what is parsed within bounds; the parser itself would take the last of two equal keys.
class Bounds {
public:
    explicit Bounds(const std::string& file) : file_(file) {}

    bool operator()(int depth, Json::parse_event_t event, const Json& parsed) {
        if (depth > deepest) refuse("is nested too deeply", fmt::format("more than {} levels", deepest));
        if (event == Json::parse_event_t::object_start) {
            objects_.emplace_back();
        } else if (event == Json::parse_event_t::object_end) {
            objects_.pop_back();
        } else if (event == Json::parse_event_t::key) {
            const auto& key = parsed.get_ref<const std::string&>();
            if (!objects_.back().insert(key).second)
                refuse(fmt::format("the key '{}' stands twice in one object", shown(key)), "");
            if (objects_.back().size() > most_keys)
                refuse("an object is too large", fmt::format("more than {} keys", most_keys));
        }
        return true;
    }

private:
    [[noreturn]] void refuse(const std::string& problem, const std::string& why) const {
        throw RecordError({file_}, problem, why, "run the scene again");
    }

    const std::string& file_;
    std::vector<std::set<std::string>> objects_;
};

/// A value with the way to it, for messages.
class Node {
public:
    Node(const Json& json, const std::string& file, std::string path)
        : json_(json), file_(file), path_(std::move(path)) {}

    [[noreturn]] void refuse(const std::string& problem, const std::string& why,
                             const std::string& hint = "run the scene again") const {
        throw RecordError({file_}, path_.empty() ? problem : shown(path_, 120) + ": " + problem, why, hint);
    }

    const std::string& file() const { return file_; }

    std::optional<Node> find(const std::string& key) const {
        require(json_.is_object(), "an object");
        const auto found = json_.find(key);
        if (found == json_.end()) return std::nullopt;
        return Node(*found, file_, path_.empty() ? key : path_ + "." + key);
    }
    Node at(const std::string& key) const {
        const std::optional<Node> found = find(key);
        if (!found) refuse(fmt::format("the key '{}' is missing", key), "");
        return *found;
    }

    /// Calls take(key, node) for each key, in the order of the file.
    template <typename Take>
    void each_key(Take&& take) const {
        require(json_.is_object(), "an object");
        for (const auto& [key, value] : json_.items())
            take(key, Node(value, file_, path_ + "." + key));
    }
    template <typename Take>
    void each_row(Take&& take) const {
        require(json_.is_array(), "an array");
        for (std::size_t i = 0; i < json_.size(); ++i)
            take(Node(json_[i], file_, fmt::format("{}[{}]", path_, i)));
    }

    std::string text() const {
        require(json_.is_string(), "text");
        return json_.get<std::string>();
    }
    bool is_text() const { return json_.is_string(); }
    double number() const {
        require(json_.is_number(), "a number");
        return json_.get<double>();
    }
    /// A count: whole and not negative.
    std::int64_t count(std::int64_t largest = std::numeric_limits<std::int64_t>::max()) const {
        require(json_.is_number_integer(), "a whole number");
        const bool negative = !json_.is_number_unsigned() && json_.get<std::int64_t>() < 0;
        if (negative || json_.get<std::uint64_t>() > static_cast<std::uint64_t>(largest))
            refuse("is out of range", fmt::format("0 to {} is possible", largest));
        return json_.get<std::int64_t>();
    }
    std::string text_at(const std::string& key) const { return at(key).text(); }
    double number_at(const std::string& key, double absent) const {
        const std::optional<Node> found = find(key);
        return found ? found->number() : absent;
    }

private:
    void require(bool right, std::string_view wanted) const {
        if (!right) refuse(fmt::format("is {} where {} belongs", type_name(), wanted), "");
    }
    std::string_view type_name() const {
        switch (json_.type()) {
            case Json::value_t::object:
                return "an object";
            case Json::value_t::array:
                return "an array";
            case Json::value_t::string:
                return "text";
            case Json::value_t::boolean:
                return "true or false";
            case Json::value_t::null:
                return "null";
            default:
                return "a number";
        }
    }
    const Json& json_;
    const std::string& file_;
    std::string path_;
};

/// The value whose name stands at `node`.
template <typename Word>
Word word(const Node& node, std::string_view (*name_of)(Word)) {
    const std::string text = node.text();
    std::string known;
    for (int i = 0;; ++i) {
        const Word value = static_cast<Word>(i);
        const std::string_view name = name_of(value);
        if (name == "unknown") break;
        if (name == text) return value;
        known += (known.empty() ? "" : ", ") + std::string(name);
    }
    node.refuse(fmt::format("'{}' is not known", shown(text)), "known: " + known,
                "read it with the version that wrote it");
}

std::vector<Input> read_inputs(const Node& node) {
    std::vector<Input> inputs;
    node.each_key([&](const std::string& key, const Node& row) {
        Input input{key, not_a_number, "", InputOrigin::given, ""};
        if (const auto value = row.find("value")) {
            if (value->is_text())
                input.value = value->text();
            else
                input.value = value->number();
        }
        if (const auto unit = row.find("unit")) input.unit = unit->text();
        input.origin = word(row.at("origin"), origin_name);
        if (const auto source = row.find("source")) input.source = source->text();
        inputs.push_back(std::move(input));
    });
    return inputs;
}

std::vector<Metric> read_metrics(const Node& values, const Node& standings) {
    std::vector<Metric> metrics;
    values.each_key([&](const std::string& key, const Node& value) {
        Metric metric{key, value.number(), Standing::result, ""};
        const Node row = standings.at(key);
        metric.standing = word(row.at("input_or_result"), standing_name);
        if (const auto note = row.find("note")) metric.note = note->text();
        metrics.push_back(std::move(metric));
    });
    return metrics;
}

EnergyLedger read_energy(const Node& node) {
    EnergyLedger energy;
    energy.kinetic = node.number_at("kinetic_J", not_a_number);
    energy.elastic = node.number_at("elastic_J", 0.0);
    energy.gravity_work = node.number_at("gravity_work_J", not_a_number);
    energy.drag_work = node.number_at("drag_work_J", 0.0);
    energy.damping = node.number_at("damping_J", 0.0);
    energy.added_mass = node.number_at("added_mass_J", 0.0);
    energy.ramp = node.number_at("ramp_J", 0.0);
    energy.external_work = node.number_at("external_work_J", 0.0);
    energy.residual_fraction = node.number_at("residual_fraction", not_a_number);
    return energy;
}

Cost read_cost(const Node& node) {
    Cost cost;
    cost.wall_s = node.number_at("wall_s", not_a_number);
    cost.cpu_s = node.number_at("cpu_s", not_a_number);
    cost.steps = node.at("steps").count();
    cost.rhs_calls = node.at("rhs_calls").count();
    cost.rejected_steps = node.at("rejected_steps").count();
    cost.dt_min_s = node.number_at("dt_min_s", not_a_number);
    cost.dt_max_s = node.number_at("dt_max_s", not_a_number);
    if (const auto steps = node.find("element_steps")) {
        cost.element_steps = steps->count();
        cost.ns_per_element_step = node.number_at("ns_per_element_step", not_a_number);
    }
    if (const auto blocks = node.find("blocks")) {
        blocks->each_key([&](const std::string& name, const Node& seconds) {
            cost.blocks.push_back({name, seconds.number()});
        });
    }
    return cost;
}

Provenance read_provenance(const Node& node) {
    Provenance made;
    made.version = node.text_at("version");
    made.commit = node.text_at("commit");
    made.compiler = node.text_at("compiler");
    made.flags = node.text_at("flags");
    made.instruction_set = node.text_at("instruction_set");
    made.host_cpu = node.text_at("host_cpu");
    made.date = node.text_at("date");
    made.threads = static_cast<int>(node.at("threads").count(std::numeric_limits<int>::max()));
    return made;
}

/// Names of files in the record's own directory: nothing else is ever looked at.
FileSums read_sums(const Node& node) {
    FileSums sums;
    node.each_key([&](const std::string& name, const Node& sum) {
        constexpr std::string_view plain =
            "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.";
        if (name.empty() || name.starts_with('.') || name.size() > 100 ||
            name.find_first_not_of(plain) != name.npos)
            node.refuse(fmt::format("'{}' is not the name of a file of a record", shown(name)), "");
        sums[name] = sum.text();
    });
    return sums;
}

void require_schema(const Node& top) {
    const auto generator = top.find("generator");
    if (!generator || !generator->is_text() || generator->text() != "twinchute")
        throw RecordError({top.file()}, "is not of a record of twinchute", "its generator is another one",
                          "name a directory that twinchute wrote");
    const std::int64_t schema = top.at("schema").count();
    if (schema != RunRecord::schema)
        top.at("schema").refuse(fmt::format("{} is not known", schema),
                                fmt::format("this version reads {}", RunRecord::schema),
                                "read it with the version that wrote it");
}

}  // namespace

RunRecord read_summary(std::string_view text, const std::string& file, FileSums& sums) {
    Json json;
    try {
        json = Json::parse(text.begin(), text.end(), Bounds(file));
    } catch (const Json::parse_error& error) {
        throw RecordError(place_of(text, error.byte, file), "is not JSON",
                          error.byte > text.size() ? "it ends too early" : "", "run the scene again");
    } catch (const Json::out_of_range&) {
        throw RecordError({file}, "holds a number that is not finite", "", "run the scene again");
    }
    const Node top(json, file, "");
    require_schema(top);
    RunRecord record;
    const Node scene = top.at("scene"), status = top.at("status");
    record.scene = {scene.text_at("name"), scene.text_at("file"), scene.text_at("sha256")};
    record.inputs = read_inputs(top.at("inputs"));
    record.fidelity = top.text_at("fidelity");
    record.status = {word(status.at("code"), status_name), status.text_at("detail")};
    record.metrics = read_metrics(top.at("metrics"), top.at("standing"));
    if (const auto energy = top.find("energy")) record.energy = read_energy(*energy);
    record.cost = read_cost(top.at("cost"));
    if (const auto estimates = top.find("estimates"))
        estimates->each_row([&](const Node& row) {
            const auto outside = row.find("outside");
            record.estimates.push_back({row.text_at("name"), row.text_at("title"), row.text_at("metric"),
                                        row.at("value").number(), row.text_at("source"),
                                        outside ? outside->text() : std::string()});
        });
    top.at("warnings").each_row([&](const Node& row) {
        record.warnings.push_back({row.text_at("what"), row.text_at("why"), row.text_at("suggestion")});
    });
    top.at("left_out").each_row([&](const Node& row) {
        record.left_out.push_back({row.text_at("what"), row.text_at("why")});
    });
    record.provenance = read_provenance(top.at("provenance"));
    if (const auto files = top.find("files")) sums = read_sums(*files);
    return record;
}

}  // namespace twinchute
