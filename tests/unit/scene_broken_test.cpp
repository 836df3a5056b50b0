// Messages about a broken scene: the place, the key, the problem and a way out.
// Lines and columns are counted by hand in good_scene (scene_text.hpp) after the edit.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tests/unit/scene_text.hpp"

namespace twinchute::test {
namespace {

struct Broken {
    const char* name;
    const char* from;  ///< replaced in good_scene
    const char* to;
    const char* begins;  ///< place and key of the message
    const char* says;    ///< a phrase of problem, why or suggestion
};

// clang-format off
const Broken cases[] = {
    {"not_toml", "mass = \"152.4 kg\"", "mass = ", "test.toml:6:8: ", "not valid TOML"},
    {"unit_without_quotes", "\"152.4 kg\"", "152.4 kg", "test.toml:6:14: ", "in quotes"},
    {"duplicate_key", "[release]", "mass = 1\n[release]", "test.toml:7:8: ", "cannot redefine"},
    {"unknown_key", "mass = \"152.4", "mas = \"152.4", "test.toml:6:1: payload.mas: ", "unknown key, did you mean 'payload.mass'?"},
    {"unknown_key_far", "mass = \"152.4", "colour = \"152.4", "test.toml:6:1: payload.colour: ", "known: mass, drag_area"},
    {"unknown_table", "[payload]", "[paylod]", "test.toml:5:2: paylod: ", "did you mean 'payload'?"},
    {"key_of_another_table", "[release]", "[release]\ndensity = 1", "test.toml:8:1: release.density: ", "did you mean 'environment.atmosphere.density'?"},
    {"not_built_yet", "[payload]", "[full]\nprecision = \"single\"\n[payload]", "test.toml:6:1: full.precision: ", "unknown key"},
    {"stop_without_physics", "time = \"6 s\"", "at = \"apogee\"", "test.toml:18:6: stop.at: ", "unknown word 'apogee' (known: steady-descent, peak-force, full-open, line-stretch, ground)"},
    {"stop_peak_force_and_time", "time = \"6 s\"", "time = \"6 s\"\nat = \"peak-force\"", "test.toml:19:6: stop.at: ", "stands beside stop.time"},
    {"stop_peak_word", "time = \"6 s\"", "at = \"peak\"", "test.toml:18:6: stop.at: ", "unknown word 'peak' (known: steady-descent, peak-force, full-open, line-stretch, ground)"},
    {"stop_height_beside_time", "time = \"6 s\"", "time = \"6 s\"\nheight = \"100 m\"", "test.toml:18:8: stop.time: ", "stands beside stop.height"},
    {"stop_above_release", "time = \"6 s\"", "altitude = \"80 km\"", "test.toml:18:12: stop.altitude: ", "the run would end before it begins"},
    {"stop_below_ground", "time = \"6 s\"", "altitude = \"-10 m\"", "test.toml:18:12: stop.altitude: ", "lies below the ground"},
    {"wind_without_from", "[payload]", "wind = { speed = 3 }\n[payload]", "test.toml:5:1: environment.wind.from: ", "is missing"},
    {"wind_empty", "[payload]", "wind = {}\n[payload]", "test.toml:5:1: environment.wind.model: ", "is missing"},
    {"wind_mixed", "[payload]", "wind = { speed = 3, from = 1, east = 2 }\n[payload]", "test.toml:5:31: environment.wind.east: ", "is not used (environment.wind.model is 'uniform')"},
    {"wind_mixed_other_way", "[payload]", "wind = { east = 2, speed = 3, from = 1 }\n[payload]", "test.toml:5:20: environment.wind.speed: ", "is not used (environment.wind.model is 'components')"},
    {"wind_not_a_table", "[payload]", "wind = \"5 m/s\"\n[payload]", "test.toml:5:8: environment.wind: ", "text where a table belongs"},
    {"wind_direction_as_ratio", "[payload]", "wind = { speed = 3, from = \"270 %\" }\n[payload]", "test.toml:5:28: environment.wind.from: ", "expected rad"},
    {"offset_as_temperature", "{ density = \"1.225 kg/m^3\" }", "{ temperature_offset = \"15 degC\" }", "test.toml:4:37: environment.atmosphere.temperature_offset: ", "has an offset"},
    {"offset_delta", "{ density = \"1.225 kg/m^3\" }", "{ temperature_offset = \"15 delta_degC\" }", "test.toml:4:37: environment.atmosphere.temperature_offset: ", "unknown unit"},
    {"offset_too_far", "{ density = \"1.225 kg/m^3\" }", "{ temperature_offset = 288 }", "test.toml:4:37: environment.atmosphere.temperature_offset: ", "out of range (allowed: >= -100 and <= 100 K)"},
    {"offset_of_constant", "{ density = \"1.225 kg/m^3\" }", "{ density = 1, temperature_offset = 2 }", "test.toml:4:29: environment.atmosphere.temperature_offset: ", "is not used"},
    {"table_not_there", "{ density = \"1.225 kg/m^3\" }", "{ table = \"none.csv\" }", "test.toml:4:24: environment.atmosphere.table: ", "there is no none.csv (looked in "},
    {"table_outside", "{ density = \"1.225 kg/m^3\" }", "{ table = \"../none.csv\" }", "test.toml:4:24: environment.atmosphere.table: ", "is not the name of a data file"},
    {"depth_of_hemisphere", "{ model = \"hemisphere\" }", "{ model = \"hemisphere\", depth_ratio = 0.4 }", "test.toml:16:38: aerodynamics.added_mass.depth_ratio: ", "is not used"},
    {"base_not_there", "schema = 1", "base = \"none.toml\"", "test.toml:1:8: base: ", "there is no scene 'none.toml'"},
    {"base_not_text", "schema = 1", "base = 3", "test.toml:1:8: base: ", "text"},
    {"case_without_brackets", "schema = 1", "schema = 1\ncase = { name = \"a\" }", "test.toml:2:1: case: ", "write [[case]] with two brackets"},
    {"case_without_name", "[stop]", "[[case]]\n[stop]", "test.toml:17:1: case.name: ", "is missing"},
    {"case_name_unsafe", "[stop]", "[[case]]\nname = \"../a b\"\n[stop]", "test.toml:18:8: case.name: ", "is not fit for a directory (letters, digits, '-', '_' and '.', at most 80 of them, no '.' or '-' at an end), write e.g. \"a-b\""},
    {"case_name_number", "[stop]", "[[case]]\nname = 3\n[stop]", "test.toml:18:8: case.name: ", "a whole number where text belongs"},
    {"case_names_alike", "[stop]", "[[case]]\nname = \"a\"\n[[case]]\nname = \"A\"\n[stop]", "test.toml:20:8: case.name: ", "'a' stands in line 17 too"},
    {"case_unknown_key", "[stop]", "[[case]]\nname = \"a\"\nsets = {}\n[stop]", "test.toml:19:1: case.sets: ", "did you mean 'set'?"},
    {"case_set_not_a_table", "[stop]", "[[case]]\nname = \"a\"\nset = 3\n[stop]", "test.toml:19:7: case.set: ", "a whole number where a table belongs"},
    {"case_sets_unknown", "[stop]", "[[case]]\nname = \"a\"\nset = { \"payload.mas\" = 3 }\n[stop]", "test.toml:19:9: case 'a': payload.mas: ", "did you mean 'payload.mass'?"},
    {"case_sets_base", "[stop]", "[[case]]\nname = \"a\"\nset = { base = \"x\" }\n[stop]", "test.toml:19:9: case 'a': base: ", "cannot be overridden"},
    {"case_sets_case", "[stop]", "[[case]]\nname = \"a\"\nset = { case = 1 }\n[stop]", "test.toml:19:9: case 'a': case: ", "cannot be overridden"},
    {"case_sets_case_name", "[stop]", "[[case]]\nname = \"a\"\nset = { \"case.name\" = \"b\" }\n[stop]", "test.toml:19:9: case 'a': case.name: ", "cannot be overridden"},
    {"case_sets_tolerance", "[stop]", "[[case]]\nname = \"a\"\nset = { \"compare.tolerance.peak\" = \"5 %\" }\n[stop]", "test.toml:19:9: case 'a': compare.tolerance.peak: ", "unknown metric"},
    {"case_sets_wrong_unit", "[stop]", "[[case]]\nname = \"a\"\nset = { \"payload.mass\" = \"3 m\" }\n[stop]", "test.toml:19:26: case 'a': payload.mass: ", "wrong kind of unit"},
    {"case_sets_what_does_not_fit", "[stop]", "[[case]]\nname = \"a\"\nset = { parachute = { risers = 3 } }\n[stop]", "test.toml:19:32: case 'a': parachute.risers: ", "3 does not divide 28 gores"},
    {"series_for_one_scene", "[stop]", "[[case]]\nname = \"a\"\n[stop]", "test.toml:1:1: case: ", "a series of 1 where a single scene is wanted"},
    {"sector_with_noise", "[stop]", "[full]\nsymmetry = \"sector\"\nnoise = { amplitude = 1e-4 }\n[stop]", "test.toml:18:12: full.symmetry: ", "one sector cannot stand for the canopy (full.noise disturbs each gore in its own way), leave full.noise out, or write"},
    {"sector_in_wind", "[stop]", "[environment.wind]\nspeed = 3\nfrom = 1\n[full]\nsymmetry = \"sector\"\n[stop]", "test.toml:21:12: full.symmetry: ", "(environment.wind carries the canopy to one side), leave environment.wind out"},
    {"sector_oblique", "path_angle = \"90 deg\"", "path_angle = \"89.9 deg\"\n[full]\nsymmetry = \"sector\"", "test.toml:12:12: full.symmetry: ", "(release.path_angle is not straight down: the canopy meets the air from one side), write path_angle = \"90 deg\""},
    {"sector_upwards", "path_angle = \"90 deg\"", "path_angle = \"-90 deg\"\n[full]\nsymmetry = \"sector\"", "test.toml:12:12: full.symmetry: ", "is not straight down"},
    {"sector_packed", "deploy = { by = \"line-stretch\" }\nfill_time = { model = \"fill-constant\", n = 4.0 }", "deploy = { by = \"free\" }\nfill_time = { model = \"fill-constant\", n = 4.0 }\n[full]\nsymmetry = \"sector\"", "test.toml:16:12: full.symmetry: ", "(drawn out of its pack each gore folds in its own way), start at line stretch"},
    {"sector_of_unequal_risers", "[[parachute]]\ndesign = \"usaf-c9\"", "[full]\nsymmetry = \"sector\"\n[[parachute]]\nrisers = 3\ndesign = \"usaf-c9\"", "test.toml:14:10: parachute.risers: ", "3 does not divide 28 gores"},
    {"contact_unknown", "[stop]", "[full]\ncontact = \"fabric\"\n[stop]", "test.toml:18:11: full.contact: ", "unknown word 'fabric' (known: none, gores, self)"},
    {"symmetry_unknown", "[stop]", "[full]\nsymmetry = \"half\"\n[stop]", "test.toml:18:12: full.symmetry: ", "unknown word 'half' (known: none, sector)"},
    {"quoted_path", "[payload]\nmass", "[payload]\n\"a.mass\"", "test.toml:6:1: payload.a.mass: ", "write keys without quotes"},
    {"wrong_dimension", "\"152.4 kg\"", "\"152.4 m\"", "test.toml:6:8: payload.mass: ", "'m' is the wrong kind of unit (it is m, expected kg)"},
    {"unknown_unit", "\"152.4 kg\"", "\"152.4 kgs\"", "test.toml:6:8: payload.mass: ", "unknown unit 'kgs'"},
    {"no_unit", "\"152.4 kg\"", "\"152.4\"", "test.toml:6:8: payload.mass: ", "has no unit (a number in quotes needs one), write e.g. \"152.4 kg\""},
    {"decimal_comma", "\"152.4 kg\"", "\"152,4 kg\"", "test.toml:6:8: payload.mass: ", "a number with a comma"},
    {"trailing_garbage", "\"152.4 kg\"", "\"152.4 kg!\"", "test.toml:6:8: payload.mass: ", "'!' is not part of a unit"},
    {"nan", "\"152.4 kg\"", "nan", "test.toml:6:8: payload.mass: ", "is not a finite number"},
    {"inf_with_unit", "\"152.4 kg\"", "\"inf kg\"", "test.toml:6:8: payload.mass: ", "is not a finite number"},
    {"negative_mass", "\"152.4 kg\"", "-3", "test.toml:6:8: payload.mass: ", "-3 kg is out of range (allowed: > 0 and <= 1e+06 kg)"},
    {"boolean", "\"152.4 kg\"", "true", "test.toml:6:8: payload.mass: ", "true or false where a number in SI or a string with a unit belongs, allowed: > 0 and <= 1e+06 kg"},
    {"array", "\"152.4 kg\"", "[1]", "test.toml:6:8: payload.mass: ", "an array where"},
    {"table_without_value", "\"152.4 kg\"", "{ source = \"x\" }", "test.toml:6:8: payload.mass: ", "a table without a value"},
    {"unknown_annotation", "\"152.4 kg\"", "{ value = 1, unit = \"kg\" }", "test.toml:6:21: payload.mass.unit: ", "a value may carry value, source and grade"},
    {"value_in_table_wrong", "\"152.4 kg\"", "{ source = \"x\", value = \"1 m\" }", "test.toml:6:32: payload.mass: ", "wrong kind of unit"},
    {"scalar_for_table", "schema = 1", "schema = 1\nfull = 3", "test.toml:2:8: full: ", "a whole number where a table belongs"},
    {"missing_key", "mass = \"152.4 kg\"", "", "test.toml:5:2: payload.mass: ", "is missing (everything below the risers, in kg)"},
    {"missing_table", "[payload]\nmass = \"152.4 kg\"\n", "", "test.toml:1:1: payload.mass: ", "is missing"},
    {"missing_schema", "schema = 1", "", "test.toml:1:1: schema: ", "is missing"},
    {"future_schema", "schema = 1", "schema = 2", "test.toml:1:10: schema: ", "2 is out of range (allowed: 1)"},
    {"empty_name", "\"test\"", "\" \"", "test.toml:2:8: name: ", "is empty"},
    {"name_not_text", "\"test\"", "9", "test.toml:2:8: name: ", "the number 9 where text in quotes belongs"},
    {"both_of_a_pair", "height = \"300 m\"", "height = 300\naltitude = 300", "test.toml:9:12: release.altitude: ", "stands beside release.height (both say the same thing)"},
    {"none_of_a_pair", "height = \"300 m\"", "", "test.toml:7:2: release.altitude: ", "give it or release.height"},
    {"speed_twice", "speed = \"21 m/s\"", "speed = 21\nairspeed = 21", "test.toml:9:9: release.speed: ", "stands beside release.airspeed"},
    {"drag_twice", "design = \"usaf-c9\"", "design = \"usaf-c9\"\ndrag_area = 42\ndrag_coefficient = 0.7", "test.toml:13:13: parachute.drag_area: ", "stands beside parachute.drag_coefficient"},
    {"stop_twice", "time = \"6 s\"", "time = \"6 s\"\nat = \"ground\"", "test.toml:19:6: stop.at: ", "stands beside stop.time"},
    {"no_path_angle", "path_angle = \"90 deg\"", "", "test.toml:9:9: release.path_angle: ", "is missing (a speed needs a direction)"},
    {"angle_as_ratio", "\"90 deg\"", "\"90 %\"", "test.toml:10:14: release.path_angle: ", "expected rad"},
    {"angle_out_of_range", "\"90 deg\"", "\"91 deg\"", "test.toml:10:14: release.path_angle: ", "91 deg is out of range (allowed: >= -90 and <= 90 deg)"},
    {"degrees_without_unit", "\"90 deg\"", "90", "test.toml:10:14: release.path_angle: ", "90 rad is out of range"},
    {"unknown_word", "\"line-stretch\"", "\"linestretch\"", "test.toml:13:17: parachute.deploy.by: ", "did you mean 'line-stretch'?"},
    {"deploy_word", "by = \"line-stretch\"", "by = \"balloon\"", "test.toml:13:17: parachute.deploy.by: ", "unknown word 'balloon' (known: static-line, free, extraction, pilot, mortar, line-stretch, inflated)"},
    {"deploy_missing", "by = \"line-stretch\"", "pitch = 0", "test.toml:13:1: parachute.deploy.by: ", "is missing"},
    {"static_line_without_length", "by = \"line-stretch\"", "by = \"static-line\"", "test.toml:13:1: parachute.deploy.length: ", "is missing"},
    {"static_line_of_nothing", "by = \"line-stretch\"", "by = \"static-line\", length = 0", "test.toml:13:41: parachute.deploy.length: ", "0 m is out of range (allowed: > 0 and <= 1000 m)"},
    {"static_line_of_a_free_one", "by = \"line-stretch\"", "by = \"free\", length = 12", "test.toml:13:25: parachute.deploy.length: ", "is not used (parachute.deploy.by is 'free')"},
    {"anchor_word", "by = \"line-stretch\"", "by = \"static-line\", length = 12, anchor = \"crane\"", "test.toml:13:54: parachute.deploy.anchor: ", "known: aircraft, fixed"},
    {"anchor_without_static_line", "by = \"line-stretch\"", "by = \"inflated\", anchor = \"fixed\"", "test.toml:13:29: parachute.deploy.anchor: ", "is not used"},
    {"retired_name_without_static_line", "by = \"line-stretch\"", "by = \"inflated\", far_end = \"fixed\"", "test.toml:13:29: parachute.deploy.anchor: ", "is not used"},
    {"retired_name_beside_the_key", "by = \"line-stretch\"", "by = \"static-line\", length = 12, anchor = \"fixed\", far_end = \"fixed\"", "test.toml:13:63: parachute.deploy.anchor: ", "is given twice (parachute.deploy.far_end is its retired name), keep anchor alone"},
    {"key_beside_its_retired_name", "by = \"line-stretch\"", "by = \"free\", fold_resistance = 1, deployment_resistance = 2", "test.toml:13:46: parachute.deploy.deployment_resistance: ", "is given twice"},
    {"extraction_without_force", "by = \"line-stretch\"", "by = \"extraction\"", "test.toml:13:1: parachute.deploy.force: ", "give it or parachute.deploy.force_table"},
    {"extraction_twice", "by = \"line-stretch\"", "by = \"extraction\", force = 9, force_table = \"f.csv\"", "test.toml:13:39: parachute.deploy.force: ", "stands beside parachute.deploy.force_table"},
    {"extraction_pushes", "by = \"line-stretch\"", "by = \"extraction\", force = -9", "test.toml:13:39: parachute.deploy.force: ", "-9 N is out of range"},
    {"extraction_table_not_there", "by = \"line-stretch\"", "by = \"extraction\", force_table = \"f.csv\"", "test.toml:13:45: parachute.deploy.force_table: ", "there is no f.csv"},
    {"force_of_a_static_line", "by = \"line-stretch\"", "by = \"static-line\", length = 12, force = 9", "test.toml:13:45: parachute.deploy.force: ", "is not used"},
    {"pack_ratio_too_long", "by = \"line-stretch\"", "by = \"free\", pack_ratio = 0.51", "test.toml:13:38: parachute.deploy.pack_ratio: ", "0.51 is out of range (allowed: > 0 and <= 0.5)"},
    {"pack_of_nothing", "by = \"line-stretch\"", "by = \"free\", pack_ratio = 0", "test.toml:13:38: parachute.deploy.pack_ratio: ", "0 is out of range"},
    {"pack_of_an_open_canopy", "by = \"line-stretch\"", "by = \"inflated\", pack_drag_area = 0.1", "test.toml:13:29: parachute.deploy.pack_drag_area: ", "is not used"},
    {"pack_drag_as_length", "by = \"line-stretch\"", "by = \"free\", pack_drag_area = \"1 m\"", "test.toml:13:42: parachute.deploy.pack_drag_area: ", "expected m^2"},
    {"pitch_beyond", "by = \"line-stretch\"", "by = \"free\", pitch = 4", "test.toml:13:33: parachute.deploy.pitch: ", "out of range"},
    {"packed_transit_too_long", "{ by = \"line-stretch\" }\nfill_time = { model = \"fill-constant\", n = 4.0 }", "{ by = \"free\" }\nfill_time = { n = 0.5 }", "test.toml:14:19: parachute.fill_time.n: ", "it lasts half a diameter, the filling 0.5 diameters, at any speed"},
    {"packed_times_too_long", "{ by = \"line-stretch\" }\nfill_time = { model = \"fill-constant\", n = 4.0 }", "{ by = \"free\" }\nfill_time = { model = \"given\", time = 2 }\ninitial_phase = 2", "test.toml:15:17: parachute.initial_phase: ", "t_i = 2 s, t_f = 2 s"},
    {"case_leaves_the_static_line", "[stop]", "[[case]]\nname = \"a\"\nset = { \"parachute.deploy\" = { by = \"free\", length = 3 } }\n[stop]", "test.toml:19:45: case 'a': parachute.deploy.length: ", "is not used"},
    {"unknown_atmosphere", "{ density = \"1.225 kg/m^3\" }", "\"us62\"", "test.toml:4:14: environment.atmosphere.model: ", "known: us76, constant"},
    {"unused_key", "n = 4.0", "n = 4.0, time = 2", "test.toml:14:49: parachute.fill_time.time: ", "is not used (parachute.fill_time.model is 'fill-constant')"},
    {"missing_in_model", "\"fill-constant\", n = 4.0", "\"given\"", "test.toml:14:1: parachute.fill_time.time: ", "is missing"},
    {"single_brackets", "[[parachute]]", "[parachute]", "test.toml:11:2: parachute: ", "write [[parachute]] with two brackets"},
    {"two_parachutes", "[aerodynamics]", "[[parachute]]\n[aerodynamics]", "test.toml:15:1: parachute.deploy.by: ", "is missing"},
    {"no_parachute", "[[parachute]]\ndesign = \"usaf-c9\"\ndeploy = { by = \"line-stretch\" }\nfill_time = { model = \"fill-constant\", n = 4.0 }\n", "", "test.toml:1:1: parachute: ", "add a [[parachute]] table"},
    {"no_design", "design = \"usaf-c9\"", "", "test.toml:11:1: parachute.nominal_diameter: ", "is missing (D0, in m)"},
    {"unknown_design", "\"usaf-c9\"", "\"usaf-c8\"", "test.toml:12:10: parachute.design: ", "there is no parachutes/usaf-c8.toml"},
    {"design_outside", "\"usaf-c9\"", "\"../parachutes/usaf-c9\"", "test.toml:12:10: parachute.design: ", "is not the name of a data file"},
    {"design_absolute", "\"usaf-c9\"", "\"/etc/passwd\"", "test.toml:12:10: parachute.design: ", "is not the name of a data file"},
    {"unknown_material", "design = \"usaf-c9\"", "design = \"usaf-c9\"\nfabric = \"silk\"", "test.toml:13:10: parachute.fabric: ", "there is no materials/silk.toml"},
    {"gores_fraction", "design = \"usaf-c9\"", "design = \"usaf-c9\"\ngores = 28.5", "test.toml:13:9: parachute.gores: ", "the number 28.5 where a whole number belongs"},
    {"risers_do_not_divide", "design = \"usaf-c9\"", "design = \"usaf-c9\"\nrisers = 3", "test.toml:13:10: parachute.risers: ", "3 does not divide 28 gores"},
    {"vent_too_large", "design = \"usaf-c9\"", "design = \"usaf-c9\"\nvent_diameter = \"8.53 m\"", "test.toml:13:17: parachute.vent_diameter: ", "the vent is not smaller than the canopy"},
    {"transit_too_long", "n = 4.0", "n = 0.5", "test.toml:14:44: parachute.fill_time.n: ", "the initial phase is not shorter than the filling time (t_i = 0.2031 s, t_f = 0.2031 s)"},
    {"initial_time_too_long", "design = \"usaf-c9\"", "design = \"usaf-c9\"\ninitial_phase = \"2 s\"", "test.toml:13:17: parachute.initial_phase: ", "t_i = 2 s, t_f = 1.625 s"},
    {"initial_word", "design = \"usaf-c9\"", "design = \"usaf-c9\"\ninitial_phase = \"now\"", "test.toml:13:17: parachute.initial_phase: ", "write transit or a quantity in s"},
    {"altitude_below_ground", "height = \"300 m\"", "altitude = \"-1 m\"", "test.toml:8:12: release.altitude: ", "the release is not above the ground (altitude -1 m, ground 0 m)"},
    {"above_the_air", "{ density = \"1.225 kg/m^3\" }\n[payload]\nmass = \"152.4 kg\"\n[release]\nheight = \"300 m\"", "\"us76\"\nground = 100\n[payload]\nmass = 1\n[release]\nheight = \"86 km\"", "test.toml:9:10: release.height: ", "86100 m is outside the atmosphere ('us76' reaches from -5000 to 86000 m)"},
    {"no_speed", "\"21 m/s\"", "0", "test.toml:9:9: release.speed: ", "a line-stretch start needs a speed"},
    {"tolerance_bare", "time = \"6 s\"", "time = \"6 s\"\n[compare.tolerance]\npeak_force = 0.1", "test.toml:20:14: compare.tolerance.peak_force: ", "a tolerance without a unit"},
    {"tolerance_unit", "time = \"6 s\"", "time = \"6 s\"\n[compare.tolerance]\npeak_force = \"1 m\"", "test.toml:20:14: compare.tolerance.peak_force: ", "expected N"},
    {"tolerance_parachute", "time = \"6 s\"", "time = \"6 s\"\n[compare.tolerance]\nmain_peak_force = \"1 N\"", "test.toml:20:19: compare.tolerance.main_peak_force: ", "unknown metric (it would be that of a parachute 'main'), did you mean 'peak_force'?"},
    {"tolerance_metric", "time = \"6 s\"", "time = \"6 s\"\n[compare.tolerance]\npeak_forces = \"1 N\"", "test.toml:20:1: compare.tolerance.peak_forces: ", "unknown metric, did you mean 'peak_force'?"},
    {"tolerance_negative", "time = \"6 s\"", "time = \"6 s\"\n[compare.tolerance]\npeak_force = \"-1 %\"", "test.toml:20:14: compare.tolerance.peak_force: ", "out of range"},
    {"empty_noise", "[stop]", "[full.noise]\n[stop]", "test.toml:17:7: full.noise.amplitude: ", "is missing"},
    {"step_factor", "[stop]", "[full]\ntime_step_factor = 5\n[stop]", "test.toml:18:20: full.time_step_factor: ", "5 is out of range (allowed: > 0 and <= 4)"},
    {"rom_method", "[stop]", "[rom]\nmethod = \"euler\"\n[stop]", "test.toml:18:10: rom.method: ", "known: auto, heun-euler, bogacki-shampine, zonneveld, dormand-prince, adams, kvaerno-3, kvaerno-4, kvaerno-5, bdf"},
    {"first_mistake_wins", "schema = 1", "schema = 1\nzzz = 1\naaa = 2", "test.toml:2:1: zzz: ", "unknown key"},
};
// clang-format on

void PrintTo(const Broken& broken, std::ostream* out) {
    *out << broken.name;
}

class BrokenScene : public testing::TestWithParam<Broken> {};

TEST_P(BrokenScene, SaysWhereAndWhat) {
    const Broken& broken = GetParam();
    const std::string what = complaint(edited(good_scene, broken.from, broken.to));
    EXPECT_TRUE(what.starts_with(broken.begins)) << what << "\nshould begin " << broken.begins;
    EXPECT_NE(what.find(broken.says), std::string::npos) << what << "\nshould say " << broken.says;
}

INSTANTIATE_TEST_SUITE_P(Scenes, BrokenScene, testing::ValuesIn(cases),
                         [](const auto& row) { return std::string(row.param.name); });

TEST(BrokenSceneBasis, IsRightUnbroken) {
    EXPECT_EQ(complaint(good_scene), "");
}

TEST(BrokenSceneError, CarriesPlaceAndKey) {
    try {
        read_text(edited(good_scene, "152.4 kg", "152.4 m"));
        FAIL() << "not refused";
    } catch (const SceneError& error) {
        EXPECT_EQ(error.place().file, "test.toml");
        EXPECT_EQ(error.place().line, 6);
        EXPECT_EQ(error.place().column, 8);
        EXPECT_EQ(error.key(), "payload.mass");
    }
}

TEST(BrokenSceneFile, ThatIsNotThere) {
    try {
        read_scene("no/such/scene.toml");
        FAIL() << "not refused";
    } catch (const SceneError& error) {
        EXPECT_STREQ(error.what(), "no/such/scene.toml: no such file, check the path");
    }
    EXPECT_THROW(read_scene(TWINCHUTE_SOURCE_DIR), SceneError);  // a directory
}

TEST(BrokenDesign, IsNamedWithItsOwnPlace) {
    const auto directory = std::filesystem::path(testing::TempDir()) / "twinchute_broken_design";
    std::filesystem::create_directories(directory / "parachutes");
    std::ofstream(directory / "parachutes" / "mine.toml") << "nominal_diametre = 8.53\n";
    std::ofstream(directory / "parachutes" / "nested.toml") << "\ndesign = \"usaf-c9\"\n";
    const auto what = [&](const char* design) -> std::string {
        try {
            read_scene_text(edited(good_scene, "usaf-c9", design), "test.toml", directory);
        } catch (const SceneError& error) {
            return error.what();
        }
        return {};
    };
    const std::string path = (directory / "parachutes").string();
    EXPECT_EQ(what("mine"),
              path + "/mine.toml:1:1: nominal_diametre: unknown key, did you mean 'nominal_diameter'?");
    EXPECT_TRUE(what("nested").starts_with(path + "/nested.toml:2:1: design: unknown key")) << what("nested");
    std::filesystem::remove_all(directory);
}

TEST(BrokenMaterial, CordWhereFabricIsWanted) {
    const std::string what = complaint(
        edited(good_scene, "design = \"usaf-c9\"", "design = \"usaf-c9\"\nfabric = \"mil-c-5040-type-ii\""));
    EXPECT_NE(
        what.find("mil-c-5040-type-ii.toml:2:18: kind: 'cord' where fabric is wanted, name another file "
                  "for parachute.fabric"),
        std::string::npos)
        << what;
}

}  // namespace
}  // namespace twinchute::test
