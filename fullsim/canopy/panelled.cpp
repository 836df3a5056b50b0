#include "fullsim/canopy/panelled.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <memory>

#include "fullsim/canopy/flat_circular.hpp"
#include "fullsim/canopy/folded_canopy.hpp"
#include "lib/models/meridian.hpp"
#include "lib/scene/needs.hpp"

namespace twinchute::fullsim {
namespace {

GoreOutline outline_of_panels(const Parachute& chute) {
    std::vector<GorePanel> panels = gore_panels(chute);
    const bool unknown = panels.empty();
    if (unknown) panels.push_back({1.0, 0.0, 0.0});
    const double area = 0.25 * pi * chute.nominal_diameter * chute.nominal_diameter;
    const auto meridian = std::make_shared<const Meridian>(unknown ? Meridian(panels, chute.gores, area)
                                                                   : gore_meridian(chute));
    std::vector<double> corners = meridian->edges();
    corners.pop_back();
    std::vector<std::array<double, 2>> gaps;
    for (std::size_t i = 1; i < panels.size(); ++i)
        if (panels[i].gap) gaps.push_back({corners[i - 1], corners[i]});
    return {chute.gores,
            pi / chute.gores,
            meridian->seam_at(polygon_radius(chute.vent_diameter, chute.gores)),
            meridian->length(),
            [meridian](double seam) {
                const MeridianPoint p = meridian->at(seam);
                return SeamPoint{p.radius, p.depth, p.centre};
            },
            std::move(corners),
            std::move(gaps),
            has_open_middle(chute)};
}

/// How gores of panels are folded before they open. With an even number of columns a gore is pleated at its
/// seams and its middle: the middle is a straight ray from the apex, and each row goes straight across from
/// it to the plane of the seam, as wide as cut. Cones are exactly so; where gores grow less in width than in
/// length, half gores twist a little about the middle. With an odd number all column lines are rays of one
/// cone, each point as far from the apex as in the cut, and the excess fabric hangs in folds finer than the
/// mesh. The whole is smaller by as much as keeps any triangle from being stretched.
class FoldedGores {
public:
    FoldedGores(const GoreOutline& outline, std::span<const NodeRow> rows, const Folding& folding)
        : outline_(outline), rows_(rows), columns_(rows.back().columns), pleated_(columns_ % 2 == 0) {
        close_to(folding.mouth_area);
        if (pleated_) return;
        // Without pleats the fabric carries the load.
        const double around = 2.0 * outline.gores * half_width(rows.back());  // [m]
        size_ *= std::sqrt(1.0 + 2.0 * folding.load /
                                     (around * folding.fabric.youngs_modulus * folding.fabric.thickness));
    }

    Vec3 node(int row, int gore, int column) const {
        const NodeRow& at = rows_[static_cast<std::size_t>(row)];
        if (row == 0 && loose_vent_ > 0.0)
            return size_ * loose_vent_ * on_line(at, gore + column, 0).normalized();
        if (!pleated_) return size_ * on_line(at, gore, column * columns_ / at.columns);
        const double share = std::abs(cut_point(outline_, at, column).x()) / half_width(at);
        const Vec3 seam = on_line(at, gore + (2 * column < at.columns ? 0 : 1), 0);
        return size_ * ((1.0 - share) * on_line(at, gore, columns_ / 2) + share * seam);
    }

private:
    double half_width(const NodeRow& row) const {
        return outline_.seam_point(row.seam).radius * std::sin(outline_.half_angle);
    }
    double centre(const NodeRow& row) const { return outline_.seam_point(row.seam).centre; }

    /// Point of a column line, at a size of one; of a pleated canopy the seam, 0, or the middle of a gore.
    Vec3 on_line(const NodeRow& row, int gore, int column) const {
        const double azimuth = 2.0 * pi * (gore * columns_ + column) / (outline_.gores * columns_);
        const double length =
            pleated_ ? centre(row)
                     : std::hypot(cut_point(outline_, {row.seam, columns_}, column).x(), centre(row));
        Eigen::Vector2d at{gather_ * length * std::sin(cone_),
                           length * std::cos(cone_)};  // from the axis, along it
        if (pleated_ && column == 0) at = pleat(row);
        return {at.x() * std::cos(azimuth), at.x() * std::sin(azimuth), at.y()};
    }

    /// Point of a seam, from the axis and along it [m]: in the plane of the seam, half a row from the middle
    /// of the gore and square to it, on the side of the axis.
    Eigen::Vector2d pleat(const NodeRow& row) const {
        const double delta = outline_.half_angle, half = half_width(row), length = centre(row);
        const double sine = std::sin(cone_), cosine = std::cos(cone_);
        // cos(turn) across and sin(turn) toward the axis: A cos(turn) + B sin(turn) = C ends on the seam's
        // plane.
        const double A = half * std::cos(delta), B = half * cosine * std::sin(delta);
        const double C = length * sine * std::sin(delta);
        const double turn = std::atan2(B, A) + std::acos(std::min(1.0, C / std::hypot(A, B)));
        const double inward = half * std::sin(turn);
        return {gather_ * ((length * sine - inward * cosine) * std::cos(delta) +
                           half * std::cos(turn) * std::sin(delta)),
                length * cosine + inward * sine};
    }

    /// Area that the skirt's ring encloses across the axis [m^2].
    double mouth() const {
        double twice = 0.0;
        const int step = pleated_ ? columns_ / 2 : 1;
        for (int k = 0; k < columns_; k += step) {
            const Vec3 a = on_line(rows_.back(), (k + step) / columns_ - k / columns_, (k + step) % columns_);
            const Vec3 b = on_line(rows_.back(), 0, k);
            twice += b.x() * a.y() - b.y() * a.x();
        }
        return 0.5 * outline_.gores * size_ * size_ * twice;
    }

    /// By bisection: the mouth opens with the angle of the rays, from where the deepest pleat reaches the
    /// axis until the narrowest row lies smooth around it. A smaller mouth is gathered.
    void close_to(double mouth_area) {
        double narrow = 1.0, wide = 0.0;  // half width over distance from the apex
        for (const NodeRow& row : rows_) {
            narrow = std::min(narrow, half_width(row) / centre(row));
            wide = std::max(wide, half_width(row) / centre(row));
        }
        const double smooth = std::asin(std::min(1.0, narrow / std::tan(outline_.half_angle)));
        const double closed = pleated_ ? std::min(smooth, std::atan(wide)) : 0.0;
        for (int pass = 0; pass < 20; ++pass) {  // size and angle hardly depend on each other
            double low = closed, high = smooth;
            for (int i = 0; i < 60; ++i) {
                cone_ = 0.5 * (low + high);
                (mouth() < mouth_area ? low : high) = cone_;
            }
            if (low == closed && pleated_) gather_ *= std::sqrt(std::min(1.0, mouth_area / mouth()));
            hang_vent();
            size_ /= largest_stretch();
        }
    }

    /// Distance from the apex at which a vent of one element across a gore starts so that its fabric hangs
    /// slack.
    void hang_vent() {
        if (rows_.front().columns == columns_) return;
        const NodeRow &vent = rows_[0], &below = rows_[1];
        const Vec3 middle = 0.5 * (on_line(vent, 0, 0).normalized() + on_line(vent, 1, 0).normalized());
        const Vec3 foot = 0.5 * (on_line(below, 0, columns_ / 2) + on_line(below, 0, (columns_ + 1) / 2));
        loose_vent_ = loose_vent_radius(middle, foot, centre(below) - centre(vent));
    }

    /// Largest length over that of the cut, in any direction of any triangle of a gore, and of tapes in gaps.
    double largest_stretch() const {
        double largest = 0.0;
        for (int row = 0; row + 1 < static_cast<int>(rows_.size()); ++row) {
            const NodeRow &upper = rows_[static_cast<std::size_t>(row)],
                          &lower = rows_[static_cast<std::size_t>(row) + 1];
            if (outline_.in_gap(0.5 * (upper.seam + lower.seam))) {
                largest = std::max(
                    largest, (node(row + 1, 0, 0) - node(row, 0, 0)).norm() / (lower.seam - upper.seam));
                continue;
            }
            const int above = upper.columns;
            for (int k = 0; k < columns_; ++k) {
                const Corner a{row + 1, k}, b{row + 1, k + 1};
                if (above < columns_) {
                    const int middle = (columns_ + 1) / 2;
                    largest = std::max(largest, stretch({row, k < middle ? 0 : 1}, a, b));
                    if (k == middle) largest = std::max(largest, stretch({row, 0}, a, {row, 1}));
                    continue;
                }
                for (const Corner& corner : {Corner{row, k}, Corner{row, k + 1}})
                    largest = std::max(largest, stretch(corner, a, b));
                for (const Corner& corner : {a, b})
                    largest = std::max(largest, stretch({row, k}, corner, {row, k + 1}));
            }
        }
        return largest;
    }

    struct Corner {
        int row, column;
    };

    double stretch(const Corner& a, const Corner& b, const Corner& c) const {
        const auto cut = [&](const Corner& p) {
            return cut_point(outline_, rows_[static_cast<std::size_t>(p.row)], p.column);
        };
        const auto folded = [&](const Corner& p) { return node(p.row, 0, p.column); };
        Eigen::Matrix2d as_cut;
        as_cut << cut(b) - cut(a), cut(c) - cut(a);
        Eigen::Matrix<double, 3, 2> now;
        now << folded(b) - folded(a), folded(c) - folded(a);
        const Eigen::Matrix<double, 3, 2> gradient = now * as_cut.inverse();
        const Eigen::Matrix2d right = gradient.transpose() * gradient;
        return std::sqrt(0.5 * right.trace() + std::hypot(0.5 * (right(0, 0) - right(1, 1)), right(0, 1)));
    }

    const GoreOutline outline_;
    const std::span<const NodeRow> rows_;
    const int columns_;
    const bool pleated_;
    double cone_ = 0.0;        // between axis and rays [rad]
    double size_ = 1.0;        // over that of the cut, along all rays
    double gather_ = 1.0;      // of distances from the axis
    double loose_vent_ = 0.0;  // [m]; none: as cut
};

CanopyNodes fold_panels(const GoreOutline& outline, std::span<const NodeRow> rows, const Folding& folding) {
    const FoldedGores folded(outline, rows, folding);
    return {folded.node(static_cast<int>(rows.size()) - 1, 0, 0),
            [=](int row, int gore, int column) { return folded.node(row, gore, column); }};
}

}  // namespace

CanopyGeometry panelled() {
    CanopyGeometry row = flat_circular();  // its tapes, and the canopies of files
    row.name = "panels";
    row.source = "developable panels: a pyramid for each cone, cylinders for arcs; folding: here";
    row.outline = &outline_of_panels;
    row.fold = &fold_panels;
    return row;
}

}  // namespace twinchute::fullsim
