// Factor on a drag area by the Mach number of the air that meets it.
#pragma once

#include <string>
#include <vector>

namespace twinchute {

/// Points of a table, straight between them; the nearer end's factor is held beyond them.
class MachDrag {
public:
    /// `mach` [-] rises from 0 or above; `factor` [-], above 0, on the drag area that is stated without it.
    /// Two points or more. `file`: as a scene names it.
    MachDrag(std::string file, std::vector<double> mach, std::vector<double> factor);

    /// [-] at a Mach number, 0 or above.
    double factor(double mach) const;

    const std::string& file() const { return file_; }
    const std::vector<double>& mach() const { return mach_; }
    const std::vector<double>& factors() const { return factor_; }

    bool operator==(const MachDrag&) const = default;

private:
    std::string file_;
    std::vector<double> mach_, factor_;
};

}  // namespace twinchute
