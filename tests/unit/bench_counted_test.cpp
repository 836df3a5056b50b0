// Operations and accesses that the benchmarks count in the loops over elements, beside the same by hand.
#include <gtest/gtest.h>

#include "fullsim/elements/cable.hpp"
#include "fullsim/elements/fabric_spring.hpp"
#include "fullsim/elements/membrane.hpp"
#include "tests/bench/counted.hpp"

namespace twinchute::bench {
namespace {

namespace law = fullsim::HWY_NAMESPACE;

// Distance and relative velocity 6; l^2 with its addend 6, 1/l 2, dl/dt 6; strain 3; EA times it 1, the
// dashpot 2; tension over length 1, along d 3; dissipated 2, and its sum 1; on either end 3.
TEST(Counted, HasTheOperationsOfACable) {
    const auto loop = [](const auto& view) { law::cable_forces(view); };
    EXPECT_EQ(tally_of<CountedSpan>(loop).operations, 6 + 6 + 2 + 6 + 3 + 1 + 2 + 1 + 3 + 2 + 1 + 6);
    EXPECT_EQ(tally_of<CountedLine>(loop).operations, tally_of<CountedSpan>(loop).operations);
    // Two places, two velocities, two forces there and back; in a chain one of each, and the force is set.
    EXPECT_EQ(tally_of<CountedSpan>(loop).words, 6 + 6 + 12);
    EXPECT_EQ(tally_of<CountedLine>(loop).words, 3 + 3 + 3);
}

// Membrane: edges and their velocities 12; both gradients 24; Green strain 20, its rate 22; principal strains
// 11, their direction 2, rate along it 7; stress 10, of viscosity 6, both 4, turned back 9; Piola-Kirchhoff
// stress 22, corners 15, power 7; forces 9. Pressure: area 12, along e_r 5, push 12, sums 2, on three
// corners 9.
TEST(Counted, HasTheOperationsOfAMembraneUnderPressure) {
    const Tally both = tally_of<CountedTriangle>(
        [](const auto& view) { law::membrane_forces<true, fullsim::AirOnFabric::pushes>(view, {}); });
    EXPECT_EQ(both.operations,
              (12 + 24 + 20 + 22 + 11 + 2 + 7 + 10 + 6 + 4 + 9 + 22 + 15 + 7 + 9) + (12 + 5 + 12 + 2 + 9));
    EXPECT_EQ(both.words, 18 + 18 + 18);
}

TEST(Counted, HasTheLengthOfAnEdgeOnceForSpringAndFold) {
    const Tally alone =
        tally_of<CountedSpan>([](const auto& view) { law::spring_forces_of<true, false>(view, {}); });
    const Tally folds =
        tally_of<CountedSpan>([](const auto& view) { law::spring_forces_of<false, true>(view, {}); });
    const Tally both =
        tally_of<CountedSpan>([](const auto& view) { law::spring_forces_of<true, true>(view, {}); });
    // Ends 6, span 14, strain 3, and 10 from tension to forces.
    EXPECT_EQ(both.operations, alone.operations + folds.operations - (6 + 14 + 3 + 10));
    EXPECT_EQ(both.words, alone.words);
}

}  // namespace
}  // namespace twinchute::bench
