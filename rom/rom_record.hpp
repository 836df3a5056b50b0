// Parts of a reduced-order record beside the metrics of an opening.
#pragma once

#include <string_view>
#include <vector>

#include "lib/record/run_record.hpp"
#include "lib/scene/scene.hpp"
#include "rom/observer.hpp"

namespace twinchute::rom {

/// East and north of the release [m] and altitude [m] of a row of a run in so many dimensions.
Vec3 place_of(const HistoryRow& row, const Scene& scene, int dimensions);

void add_channels(RunRecord& record, const std::vector<HistoryRow>& rows, const Scene& scene, int dimensions);

/// Whether a metric of that key comes from the channels of a record.
bool needs_channels(std::string_view key);

/// Both closed forms of the snatch force beside what was integrated, and a warning where the lines were
/// stretched further than cord goes. separation_speed [m/s]: along the lines when they come taut; stretch
/// [-].
void add_snatch_forms(RunRecord& record, const Scene& scene, const Parachute& chute, double separation_speed,
                      double stretch);

}  // namespace twinchute::rom
