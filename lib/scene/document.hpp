// A TOML file as a flat list of known keys, each with its place. No units or ranges yet.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "lib/record/run_record.hpp"
#include "lib/scene/keys.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute {

/// Whether a place is an option of the command line, e.g. "--set", and what stands there an override.
bool is_override(std::string_view file);

/// Value before its key interprets it.
using RawValue = std::variant<std::int64_t, double, std::string, std::vector<std::string>>;

struct Entry {
    const Key* key = nullptr;
    RawValue value;
    SourcePlace key_place, value_place;
    std::string source;  ///< from { value = ..., source = "..." }
    InputOrigin origin = InputOrigin::given;
    std::filesystem::path directory;  ///< where files that the value names are looked for first
};

struct DocumentCase;

struct Document {
    std::string file;                           ///< for messages about what is not there
    std::map<std::string, Entry> entries;       ///< by path, e.g. "parachute.fill_time.n"
    std::map<std::string, SourcePlace> tables;  ///< the tables that are present
    std::set<std::string> lists;                ///< given as a whole: they replace what lies below
    /// [[parachute]] but the first, each with keys that begin with "parachute."; of what is laid over a
    /// scene, keys of a parachute by its name or number.
    std::vector<Document> parachutes;
    std::map<std::string, Document> named_parachutes;
    std::vector<DocumentCase> cases;  ///< a series, see [[case]]
    std::vector<Warning> warnings;    ///< about keys that are read by their retired paths
    /// [m] D0 of the design below, where the scene has another key of it.
    std::optional<double> design_diameter = {};
    /// Keys of a design or type that prescribe a filling which the scene has predicted.
    std::vector<std::string> overridden = {};
};

/// One case of a series: keys to lay over the rest.
struct DocumentCase {
    std::string name;
    SourcePlace place;
    Document set;
};

/// Which table of keys a file is read with.
struct DocumentKind {
    std::span<const Key> keys;
    std::string prefix = {};  ///< of every key in the file: "" for a scene, "parachute." for a design
    InputOrigin origin = InputOrigin::given;
    std::string asked_by = {};             ///< the key that named the file, for messages
    std::filesystem::path directory = {};  ///< of the entries
};

/// Parses TOML and matches every key with its row. Throws SceneError: not TOML, an unknown key, a
/// table where a value belongs or the other way round.
Document read_document(std::string_view text, const std::string& file, const DocumentKind& kind);

/// One "key=value" as a document; messages name "--set", or the option that stands before it: "--fields
/// key=value". A value that is not TOML is taken as text.
Document read_override(const std::string& override_text, const DocumentKind& kind);

/// Lays `upper` over `lower`. A key above also removes from below what cannot stand beside it: the
/// other way to say the same (altitude and height), and parameters of another model.
void overlay(Document& lower, const Document& upper);

/// Whether it asks for a predicted filling.
bool predicts_filling(const Document& document);

/// The parameters of a model imply it: { density = ... } is a constant atmosphere. Of parameters that
/// do not belong together the first in the file decides; the others are then refused as unused.
void imply_models(Document& document);

/// A quantity of a document in SI; nothing where it is absent, or wrong, which its own check says.
std::optional<double> quantity(const Document& document, std::string_view path);

/// "case 'x'", as messages call it.
std::string case_title(std::string_view name);

/// The key as it is written in a file of that kind.
std::string_view shown_path(std::string_view path, std::string_view prefix);

}  // namespace twinchute
