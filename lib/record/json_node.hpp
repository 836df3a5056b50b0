// Foreign JSON, read with care: bounded in depth and keys, every value with the way to it for messages.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>

#include "lib/record/record_error.hpp"

namespace twinchute {

/// A foreign word in a message: short, and no control characters.
std::string shown(std::string_view text, std::size_t longest = 40);

/// A value with the way to it. Whatever is asked of it and not so throws RecordError with file and way.
class JsonNode {
public:
    JsonNode(const nlohmann::ordered_json& json, const std::string& file, std::string path)
        : json_(json), file_(file), path_(std::move(path)) {}

    [[noreturn]] void refuse(const std::string& problem, const std::string& why,
                             const std::string& hint = "run the scene again") const;

    const std::string& file() const { return file_; }

    std::optional<JsonNode> find(const std::string& key) const;
    JsonNode at(const std::string& key) const;

    /// Calls take(key, node) for each key, in the order of the file.
    template <typename Take>
    void each_key(Take&& take) const {
        for (std::size_t i = 0; i < keys(); ++i)
            take(key(i), value(i));
    }
    template <typename Take>
    void each_row(Take&& take) const {
        for (std::size_t i = 0; i < rows(); ++i)
            take(row(i));
    }

    std::string text() const;
    bool is_text() const;
    bool truth() const;
    double number() const;
    /// A count: whole and not negative.
    std::int64_t count(std::int64_t largest = std::numeric_limits<std::int64_t>::max()) const;
    std::string text_at(const std::string& key) const { return at(key).text(); }
    double number_at(const std::string& key, double absent) const;

private:
    void require(bool right, std::string_view wanted) const;
    std::string_view type_name() const;
    std::size_t keys() const;
    std::string key(std::size_t i) const;
    JsonNode value(std::size_t i) const;
    std::size_t rows() const;
    JsonNode row(std::size_t i) const;

    const nlohmann::ordered_json& json_;
    const std::string& file_;
    std::string path_;
};

/// A parsed text; its nodes live as long as it and `file` do.
class JsonDocument {
public:
    /// Throws RecordError: no JSON, too deep, too many keys, a key twice, a number that is not finite.
    JsonDocument(std::string_view text, const std::string& file);
    ~JsonDocument();
    JsonDocument(const JsonDocument&) = delete;
    JsonDocument& operator=(const JsonDocument&) = delete;

    JsonNode top() const;

private:
    std::unique_ptr<nlohmann::ordered_json> json_;
    const std::string& file_;
};

/// The value whose name stands at `node`.
template <typename Word>
Word json_word(const JsonNode& node, std::string_view (*name_of)(Word)) {
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

}  // namespace twinchute
