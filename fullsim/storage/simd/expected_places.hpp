// Where several nodes are expected by a linear motion. Included once for every instruction set (see
// fullsim/laws/membrane.hpp for the guard).
#if defined(TWINCHUTE_LANES_EXPECTED_PLACES) == defined(HWY_TARGET_TOGGLE)
#ifdef TWINCHUTE_LANES_EXPECTED_PLACES
#undef TWINCHUTE_LANES_EXPECTED_PLACES
#else
#define TWINCHUTE_LANES_EXPECTED_PLACES
#endif

#include "fullsim/laws/linear_motion.hpp"
#include "fullsim/storage/simd/vec.hpp"

HWY_BEFORE_NAMESPACE();
namespace twinchute::fullsim::HWY_NAMESPACE {

class ExpectedPlaces {
public:
    explicit HWY_INLINE ExpectedPlaces(const LinearMotion& motion) : centre_(all3(motion.centre.data())) {
        for (int c = 0; c < 3; ++c)
            column_[c] = all3(motion.stretch.data() + 3 * c);
    }
    HWY_INLINE Vec3s of(Vec3s x) const {
        return centre_ + x.x * column_[0] + x.y * column_[1] + x.z * column_[2];
    }

private:
    static HWY_INLINE Vec3s all3(const double* of) { return {all(of[0]), all(of[1]), all(of[2])}; }

    Vec3s centre_, column_[3];
};

}  // namespace twinchute::fullsim::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
