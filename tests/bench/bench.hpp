// Benchmarks, a group a file. Every group registers its benchmarks with Google Benchmark; user counters
// carry what docs/cost.md quotes, with the unit in their name.
#pragma once

#include <string>

namespace twinchute::bench {

// Scenes that are measured.
constexpr const char *c9_inflation = "c9-inflation.toml", *crane_drop = "paper/crane-drop.toml";

inline std::string path_of(const char* scene) {
    return std::string(TWINCHUTE_SOURCE_DIR) + "/data/scenes/" + scene;
}

/// Ceilings of this machine: multiply-adds, reading and copying memory.
void register_ceilings();
/// Force blocks, node update and whole steps, each on several meshes in flight.
void register_elements();
/// Stages of the reduced-order model by every method, and by integrators of other libraries.
void register_methods();
/// Whole runs, split by stage, and whole processes from start to end.
void register_runs();

}  // namespace twinchute::bench
