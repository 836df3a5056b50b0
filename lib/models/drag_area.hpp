// Growth of the drag area during filling: value and rate, so that no caller differentiates.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace twinchute {

struct ValueAndRate {
    double value = 0.0;
    double rate = 0.0;
};

/// A row of the table of drag-area laws.
struct DragAreaLaw {
    std::string_view name;
    std::string_view source;
    /// (C_D S)_t/(C_D S)_0 and its derivative with respect to x, for the fill fraction
    /// x in [0, 1] and eta = sqrt((C_D S)_i/(C_D S)_0) in [0, 1].
    ValueAndRate (*at)(double x, double eta);
    /// Integral of that ratio from 0 to x: what brakes a body that nothing but drag acts on.
    double (*integral)(double x, double eta);
};

std::span<const DragAreaLaw> drag_area_laws();
const DragAreaLaw* find_drag_area_law(std::string_view name);

/// A measured growth in place of a law, between its points by Steffen's cubics: smooth in value and slope,
/// and never beyond the points on either side (Steffen, Astron. Astrophys. 239 (1990) 443; GSL). Smooth but
/// for its kinks, between which it is pieces with cubics of their own (a straight line through two points):
/// a kink is a point that stands there twice, or one at which the slope from point to point changes more than
/// ten times as much as at its two neighbours together.
class DragAreaTable {
public:
    /// `ratio`: (C_D S)_t/(C_D S)_0 at the fill fractions `fraction`, which rise from 0, each once or twice,
    /// then with one ratio. At fraction 1 the ratio is 1; beyond, while the canopy over-inflates, it ends at
    /// 1 again. Three different points or more.
    DragAreaTable(std::string file, std::vector<double> fraction, std::vector<double> ratio);

    /// Ratio and its rate at x; on a kink, to round-off, by the piece of that number.
    ValueAndRate at(double x, std::size_t piece = 0) const;
    double integral(double x) const;  ///< from 0
    double end() const { return fraction_.back(); }
    double start_ratio() const { return ratio_.front(); }
    /// Fill fraction of the kink in which piece `piece` ends; infinite of the last.
    double kink_after(std::size_t piece) const;
    std::size_t pieces() const { return pieces_.size(); }
    const std::string& file() const { return file_; }
    const std::vector<double>& fraction() const { return fraction_; }
    const std::vector<double>& ratio() const { return ratio_; }

    bool operator==(const DragAreaTable& other) const {
        return file_ == other.file_ && fraction_ == other.fraction_ && ratio_ == other.ratio_;
    }

private:
    struct Piece {
        std::size_t first, last;             // of its points
        std::shared_ptr<const void> cubics;  // gsl_interp
    };
    bool reaches(const Piece& piece, double x) const;

    std::string file_;  ///< as the scene names it
    std::vector<double> fraction_, ratio_;
    std::vector<Piece> pieces_;
};

/// How one drag area grows: by a law, or by a table or a power where there is one.
struct DragAreaGrowth {
    const DragAreaLaw* law = nullptr;
    double eta = 0.0;
    const DragAreaTable* table = nullptr;
    double exponent = 0.0;  ///< j of eta^2 + (1 - eta^2) x^j [-] in place of the law; 0: none

    /// `piece`: of the table, see there.
    ValueAndRate at(double x, std::size_t piece = 0) const {
        return table != nullptr ? table->at(x, piece) : exponent > 0.0 ? power(x) : law->at(x, eta);
    }
    double integral(double x) const {
        return table != nullptr ? table->integral(x)
               : exponent > 0.0 ? power_integral(x)
                                : law->integral(x, eta);
    }
    /// The fill fraction from which on the drag area is steady; 1 unless the canopy over-inflates.
    double end() const { return table != nullptr ? table->end() : 1.0; }

private:
    ValueAndRate power(double x) const;
    double power_integral(double x) const;
};

}  // namespace twinchute
