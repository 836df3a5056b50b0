#include "lib/record/json_node.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>
#include <vector>

namespace twinchute {
namespace {

using Json = nlohmann::ordered_json;

// Looking up a key walks the object, so that a large one costs the square of its size.
constexpr std::size_t max_keys = 2048;
constexpr int deepest = 32;

/// Line and column of a byte, which the parser counts from 1.
RecordPlace place_of(std::string_view text, std::size_t byte, const std::string& file) {
    const std::string_view before = text.substr(0, std::min(text.size(), byte == 0 ? 0 : byte - 1));
    const std::size_t feed = before.rfind('\n');
    return {file, static_cast<int>(std::ranges::count(before, '\n')) + 1,
            static_cast<int>(before.size() - (feed == before.npos ? 0 : feed + 1)) + 1};
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
            if (objects_.back().size() > max_keys)
                refuse("an object is too large", fmt::format("more than {} keys", max_keys));
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

}  // namespace

std::string shown(std::string_view text, std::size_t longest) {
    std::string clean(text.substr(0, longest));
    std::ranges::replace_if(
        clean, [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
    return text.size() > longest ? clean + "..." : clean;
}

void JsonNode::refuse(const std::string& problem, const std::string& why, const std::string& hint) const {
    throw RecordError({file_}, path_.empty() ? problem : shown(path_, 120) + ": " + problem, why, hint);
}

std::optional<JsonNode> JsonNode::find(const std::string& key) const {
    require(json_.is_object(), "an object");
    const auto found = json_.find(key);
    if (found == json_.end()) return std::nullopt;
    return JsonNode(*found, file_, path_.empty() ? key : path_ + "." + key);
}

JsonNode JsonNode::at(const std::string& key) const {
    const std::optional<JsonNode> found = find(key);
    if (!found) refuse(fmt::format("the key '{}' is missing", key), "");
    return *found;
}

std::size_t JsonNode::keys() const {
    require(json_.is_object(), "an object");
    return json_.size();
}

std::string JsonNode::key(std::size_t i) const {
    return std::next(json_.begin(), static_cast<std::ptrdiff_t>(i)).key();
}

JsonNode JsonNode::value(std::size_t i) const {
    const auto at = std::next(json_.begin(), static_cast<std::ptrdiff_t>(i));
    return JsonNode(*at, file_, path_ + "." + at.key());
}

std::size_t JsonNode::rows() const {
    require(json_.is_array(), "an array");
    return json_.size();
}

JsonNode JsonNode::row(std::size_t i) const {
    return JsonNode(json_[i], file_, fmt::format("{}[{}]", path_, i));
}

std::string JsonNode::text() const {
    require(json_.is_string(), "text");
    return json_.get<std::string>();
}

bool JsonNode::is_text() const {
    return json_.is_string();
}

bool JsonNode::truth() const {
    require(json_.is_boolean(), "true or false");
    return json_.get<bool>();
}

double JsonNode::number() const {
    require(json_.is_number(), "a number");
    return json_.get<double>();
}

std::int64_t JsonNode::count(std::int64_t largest) const {
    require(json_.is_number_integer(), "a whole number");
    const bool negative = !json_.is_number_unsigned() && json_.get<std::int64_t>() < 0;
    if (negative || json_.get<std::uint64_t>() > static_cast<std::uint64_t>(largest))
        refuse("is out of range", fmt::format("0 to {} is possible", largest));
    return json_.get<std::int64_t>();
}

double JsonNode::number_at(const std::string& key, double absent) const {
    const std::optional<JsonNode> found = find(key);
    return found ? found->number() : absent;
}

void JsonNode::require(bool right, std::string_view wanted) const {
    if (!right) refuse(fmt::format("is {} where {} belongs", type_name(), wanted), "");
}

std::string_view JsonNode::type_name() const {
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

JsonDocument::JsonDocument(std::string_view text, const std::string& file) : file_(file) {
    try {
        json_ = std::make_unique<Json>(Json::parse(text.begin(), text.end(), Bounds(file)));
    } catch (const Json::parse_error& error) {
        throw RecordError(place_of(text, error.byte, file), "is not JSON",
                          error.byte > text.size() ? "it ends too early" : "", "run the scene again");
    } catch (const Json::out_of_range&) {
        throw RecordError({file}, "holds a number that is not finite", "", "run the scene again");
    }
}

JsonDocument::~JsonDocument() = default;

JsonNode JsonDocument::top() const {
    return JsonNode(*json_, file_, "");
}

}  // namespace twinchute
