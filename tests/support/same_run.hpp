// Two records of one run: the same to the last bit, but for what it cost and when it was.
#pragma once

#include "tests/support/same_record.hpp"

namespace twinchute::test {

/// Without date and what clocks measured; how many steps a run took stays.
inline RunRecord without_clocks(RunRecord record) {
    Cost& cost = record.cost;
    cost.wall_s = cost.cpu_s = cost.ns_per_element_step = 0.0;
    for (BlockCost& block : cost.blocks)
        block.seconds = 0.0;
    cost.resumed_at.clear();
    record.provenance.date.clear();
    return record;
}

/// Empty where they are the same.
inline std::string run_difference(const RunRecord& a, const RunRecord& b) {
    return record_difference(without_clocks(a), without_clocks(b));
}

}  // namespace twinchute::test
