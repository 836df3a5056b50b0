#include "fullsim/run/frames.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

namespace twinchute::fullsim {
namespace {

// [bytes] for all frames of a run: those of the C-9 take 14 kB each, those of the finest meshes 600 kB.
constexpr std::size_t most_memory = 24u << 20;
constexpr std::size_t fewest_frames = 8;

FabricFolds folds_of(FabricState state) {
    switch (state) {
        case FabricState::slack:
            return FabricFolds::slack;
        case FabricState::wrinkled:
            return FabricFolds::wrinkled;
        case FabricState::taut:
            break;
    }
    return FabricFolds::taut;
}

ShapeCableKind shape_kind(CableKind kind) {
    switch (kind) {
        case CableKind::radial:
            return ShapeCableKind::radial;
        case CableKind::skirt:
            return ShapeCableKind::skirt;
        case CableKind::vent:
            return ShapeCableKind::vent;
        case CableKind::line:
            return ShapeCableKind::line;
        case CableKind::riser:
            return ShapeCableKind::riser;
        case CableKind::vent_line:
            return ShapeCableKind::vent_line;
        case CableKind::static_line:
            break;
    }
    return ShapeCableKind::static_line;
}

}  // namespace

FrameRecorder::FrameRecorder(std::vector<const Mesh*> meshes, bool wanted, int sectors)
    : meshes_(std::move(meshes)),
      laws_(membrane_laws(*meshes_.front(), 0.0)),
      wanted_(wanted),
      most_frames_(0),
      sectors_(static_cast<std::size_t>(sectors)),
      next_(std::numeric_limits<double>::infinity()) {
    if (!wanted) return;
    for (const Mesh* mesh : meshes_)
        add_mesh(*mesh);
    shape_.payload = static_cast<std::uint32_t>(meshes_.front()->payload());
    most_frames_ = std::max(fewest_frames, most_memory / bytes_per_frame(shape_));
}

void FrameRecorder::add_mesh(const Mesh& mesh) {
    const std::uint32_t first = shape_.nodes;
    const auto node = [&](NodeIndex i) { return first + static_cast<std::uint32_t>(i); };
    // The dummy has no place in a frame: what comes after it moves up by one.
    // Risers are drawn to the middle of a body.
    const auto moved_up = [&](NodeIndex i) {
        const NodeIndex tether = mesh.first_static_line_node();
        return node(i >= tether ? i - tether + mesh.node_count() : std::min(i, mesh.payload()));
    };
    const std::size_t tether_nodes = mesh.static_line.position.size();
    shape_.nodes = node(mesh.node_count()) + static_cast<std::uint32_t>(tether_nodes);
    for (const Triangle& t : mesh.triangles)
        shape_.triangles.push_back({node(t.node[0]), node(t.node[1]), node(t.node[2])});
    for (const auto* cables : {&mesh.cables, &mesh.static_line.cables})
        for (const Cable& c : *cables)
            shape_.cables.push_back({{moved_up(c.node[0]), moved_up(c.node[1])}, shape_kind(c.kind)});
    tether_nodes_.push_back(tether_nodes);
    apex_.push_back(tether_nodes > 0 ? mesh.static_line.cables.front().node[0] : 0);
}

void FrameRecorder::begin(double time, const FrameStretch& stretch) {
    if (!wanted_) return;
    stretch_ = {stretch.interval, std::min(stretch.most, most_frames_)};
    begin_ = next_ = time;
    first_ = shape_.frames.size();
    // Frames of an earlier stretch that are not yet accepted are no longer thinned.
}

void FrameRecorder::take(std::span<const State* const> states) {
    const double time = states.front()->time;
    if (!shape_.frames.empty() && !(time > shape_.frames.back().time)) return;
    place_.clear();
    stress_.clear();
    std::vector<FabricFolds> folds;
    folds.reserve(shape_.triangles.size());
    for (std::size_t k = 0; k < states.size(); ++k) {
        add_places(*states[k], k);
        add_stresses(*states[k], *meshes_[k], folds);
    }
    shape_.frames.push_back(quantised(time, place_, stress_, std::move(folds)));
    next_ = begin_ + stretch_.interval * (std::floor((time - begin_) / stretch_.interval + 1e-9) + 1.0);
}

void FrameRecorder::add_places(const State& state, std::size_t k) {
    const Mesh& mesh = *meshes_[k];
    const auto add = [&](NodeIndex i) {
        for (int c = 0; c < 3; ++c)
            place_.push_back(state.node[i].x[c]);
    };
    for (NodeIndex i = 0; i < mesh.node_count(); ++i)
        add(i);
    // A static line that has let go is a point at the apex.
    const bool tethered = !mesh.static_line.cables.empty();
    for (std::size_t n = 0; n < tether_nodes_[k]; ++n)
        add(tethered ? mesh.first_static_line_node() + static_cast<NodeIndex>(n) : apex_[k]);
}

void FrameRecorder::add_stresses(const State& state, const Mesh& mesh, std::vector<FabricFolds>& folds) {
    const std::size_t first_sector = mesh.triangles.size() / sectors_, before = stress_.size();
    for (const Triangle& t : std::span(mesh.triangles).first(first_sector)) {
        FabricState wrinkling{};
        const PlaneTensor stress =
            membrane_stress(laws_[static_cast<std::size_t>(t.sheet)], green_strain(t, state), &wrinkling);
        stress_.push_back(state.fe_weight * principal_values(stress).first);
        folds.push_back(folds_of(wrinkling));
    }
    for (std::size_t t = first_sector; t < mesh.triangles.size(); ++t) {
        stress_.push_back(stress_[before + t - first_sector]);
        folds.push_back(folds[before + t - first_sector]);
    }
}

void FrameRecorder::accept() {
    auto& frames = shape_.frames;
    while (frames.size() > first_ + stretch_.most) {
        std::size_t kept = first_;
        for (std::size_t i = first_; i < frames.size(); i += 2, ++kept)
            if (kept != i) frames[kept] = std::move(frames[i]);
        frames.resize(kept);
        stretch_.interval *= 2.0;
        next_ = begin_ + stretch_.interval *
                             (std::floor((frames.back().time - begin_) / stretch_.interval + 1e-9) + 1.0);
    }
    accepted_ = frames.size();
}

void FrameRecorder::serialize(Archive& archive) {
    bool wanted = wanted_;
    archive.flag("shapes", wanted);
    if (wanted != wanted_) archive.refuse("is of a run with another output", "shapes for a report, or none");
    archive.number("interval of shapes", stretch_.interval);
    archive.whole("most shapes", stretch_.most);
    archive.number("begin of shapes", begin_);
    archive.number("next shape", next_);
    archive.length("shapes", shape_.frames, 1'000'000);
    archive.whole("shapes before", first_, 0, shape_.frames.size());
    archive.whole("accepted shapes", accepted_, 0, shape_.frames.size());
    for (ShapeFrame& frame : shape_.frames) {
        auto& [time, corner, step, stress_step, place, stress, folds] = frame;
        archive.number("time", time);
        archive.numbers("corner", std::span(corner));
        archive.number("step", step);
        archive.number("stress step", stress_step);
        archive.small("place", place);
        archive.small("stress", stress);
        archive.small("folds", folds);
    }
}

ShapeFrames FrameRecorder::finish() {
    forget();
    next_ = std::numeric_limits<double>::infinity();
    return std::move(shape_);
}

}  // namespace twinchute::fullsim
