// The one table of what a scene may say. It serves the reader, `twinchute list keys` and the docs.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace twinchute {

enum class KeyKind {
    quantity,          ///< a number in SI, or a string with a unit
    quantity_or_word,  ///< the same, or one of `choices`
    integer,           ///< a whole number
    word,              ///< one of `choices`
    text,              ///< any text, not empty
    data_file,         ///< the name of a file in `folder` of the data, without .toml
    list,              ///< an array of texts: words of `choices`, names of files in `folder`, or any
    csv_file,          ///< the name of a CSV file beside the scene or in the data
    mesh_file,         ///< likewise, of a Gmsh file
    tolerance,         ///< a table of metrics, each "10 %" or absolute in the metric's unit
    tables,            ///< a list of tables: their keys are those below it, with a number from 1 between
    quantities,        ///< a list of quantities, each with its number from 1 behind the path
    table              ///< physics that is left out when its table is absent
};

enum class KeyNeed {
    required,   ///< by every scene that has the table it stands in
    defaulted,  ///< absent: `fallback`
    optional    ///< absent: left out
};

/// Who reads it.
enum class KeyUser { both, rom, full, compare, size, campaign };

/// From low to high, in SI. Everything but +-infinity is allowed by default.
struct KeyRange {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool above_low = false;   ///< low itself is out
    bool below_high = false;  ///< high itself is out

    bool contains(double value) const {
        return (above_low ? value > low : value >= low) && (below_high ? value < high : value <= high);
    }
};

/// A value of a key in SI; of a quantity_or_word either.
using KeyValue =
    std::variant<double, std::int64_t, std::string, std::vector<std::string>, std::vector<double>>;
using OptionalValue = std::optional<KeyValue>;  ///< nothing: absent

/// How a key's value goes into an object of a scene and comes out of it again.
template <class Object>
struct BindingOf {
    void (*set)(Object& object, const KeyValue& value) = nullptr;  ///< null: the reader knows how
    OptionalValue (*get)(const Object& object) = nullptr;          ///< nothing: absent; null: never written
};

struct Scene;
struct Parachute;
struct Reefing;
struct FillTime;
struct Trigger;
struct Fabric;
struct Cord;
struct PanelMaterials;
using Binding = std::variant<std::monostate, BindingOf<Scene>, BindingOf<Parachute>, BindingOf<Reefing>,
                             BindingOf<FillTime>, BindingOf<Trigger>, BindingOf<PanelMaterials>,
                             BindingOf<Fabric>, BindingOf<Cord>>;

struct Key {
    std::string_view path;  ///< e.g. "parachute.fill_time.n"; [[parachute]] counts as a table
    Binding binding = {};   ///< see binding.hpp; none: what is not a value of the scene
    KeyKind kind = KeyKind::quantity;
    std::string_view unit = {};  ///< SI; "1" for ratios, empty for words and whole numbers
    KeyNeed need = KeyNeed::required;
    std::string_view fallback = {};  ///< in SI, or a word
    KeyRange range = {};
    std::vector<std::string_view> (*choices)() = nullptr;
    std::string_view folder = {};      ///< of a data_file
    std::string_view instead_of = {};  ///< exactly one of this key and those, "a|b", is given
    std::string_view only_with = {};   ///< used only with these words, "a|b", of the selector beside it
    KeyUser user = KeyUser::both;
    std::string_view meaning = {};
    std::string_view source = {};    ///< of the definition or of the default
    std::string_view formerly = {};  ///< retired paths "a|b", which are read with a warning

    /// A whole number or a quantity, as opposed to words.
    bool is_number() const {
        return kind == KeyKind::quantity || kind == KeyKind::integer || kind == KeyKind::quantities;
    }
    bool has_members() const { return kind == KeyKind::tables || kind == KeyKind::quantities; }
    /// Decides which of the keys beside it are used: `model`, or `by` of a deployment.
    bool is_selector() const { return path.ends_with(".model") || path.ends_with(".by"); }
    /// Whether it is used with this word of its selector.
    bool goes_with(std::string_view word) const;
    /// The unit to write to a record: empty for ratios.
    std::string_view record_unit() const { return unit == "1" ? std::string_view{} : unit; }
};

/// "a.b.c" below "a" and "a.b"; everything below "".
bool is_below(std::string_view path, std::string_view table);

/// The words of a list "a|b|c".
std::vector<std::string_view> words_of(std::string_view list);

/// Keys of a scene.
std::span<const Key> scene_keys();

/// Keys of a design file, written there without "parachute.": what belongs to the parachute
/// whatever the scene. The same rows, in a table of their own.
std::span<const Key> design_keys();

/// Keys of a material file, written there without "fabric." or "cord.".
std::span<const Key> fabric_keys();
std::span<const Key> cord_keys();
std::span<const Key> material_keys();  ///< both

/// The selector beside a key that is not used with all of its words.
const Key* selector_of(std::span<const Key> keys, const Key& key);

/// Whether the key prescribes how a canopy fills, which a predicted filling takes its place of; numbers of a
/// list's members do not count.
bool prescribes_filling(std::string_view path);

/// The row of a path in a table of keys, or null; the numbers of a list's members are not part of a row.
const Key* find_key(std::span<const Key> keys, std::string_view path);

/// The row of which this is a retired path, or null.
const Key* find_successor(std::span<const Key> keys, std::string_view path);

/// The path without the numbers of list members: "parachute.reefing.2.until.at" to
/// "parachute.reefing.until.at".
std::string row_path(std::span<const Key> keys, std::string_view path);

/// The path of a row in the list member that `like` stands in: "parachute.reefing.until.time" beside
/// "parachute.reefing.2.until.at" to "parachute.reefing.2.until.time".
std::string beside(std::string_view row, std::string_view like);

/// The number in a default, whatever the locale: defaults are plain SI, so that none needs a unit.
double plain_number(std::string_view fallback);

/// "required", or the default with its unit, or "left out".
std::string default_text(const Key& key);

/// "> 0", "0 to 1", one of the words, ...
std::string range_text(const Key& key);

/// "allowed: > 0 and <= 1e+06 kg", for messages.
std::string allowed_text(const Key& key);

/// "both", "rom", "full", "compare", "size" or "campaign".
std::string_view user_name(KeyUser user);

/// Rows at this path and below it, of scenes and materials, in the order of the tables; "": all of them.
std::vector<const Key*> keys_below(std::string_view path);

/// Keys as aligned plain text, one a line, below a line of heads: to search in.
std::string keys_table(const std::vector<const Key*>& keys);

/// Keys with what is said of each below it, in lines of `width` columns: to read.
std::string keys_wrapped(const std::vector<const Key*>& keys, std::size_t width);

/// All that the table says of a key, a line each; of `width` columns, 0: as long as they are.
std::string key_page(const Key& key, std::size_t width);

}  // namespace twinchute
