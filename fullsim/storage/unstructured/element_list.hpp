// Elements of the unstructured layout in groups of SIMD lanes: node offsets and constants.
#pragma once

#include <array>
#include <vector>

#include "fullsim/state.hpp"
#include "fullsim/storage/unstructured/kernels.hpp"
#include "lib/solve/plan.hpp"

namespace twinchute::fullsim::unstructured {

/// Elements one after the other, as the kernels want them in groups.
class ElementList {
public:
    /// padding: constants of an element without effect.
    template <std::size_t corners, std::size_t constants>
    void begin(std::size_t count, int lanes, NodeIndex dummy, const std::array<double, constants>& padding) {
        const std::size_t width = static_cast<std::size_t>(lanes);
        lanes_ = width, corners_ = corners, constants_ = constants;
        groups_ = (count + width - 1) / width;
        node_.assign(groups_ * corners * width, row_offset(dummy));
        node_.shrink_to_fit();
        constant_.assign((groups_ * constants * width + Line{}.size() - 1) / Line{}.size(), Line{});
        constant_.shrink_to_fit();
        for (std::size_t i = count; i < groups_ * width; ++i)
            set_constants(i, padding);
    }

    template <std::size_t corners, std::size_t constants>
    void set(std::size_t i, const std::array<NodeIndex, corners>& node,
             const std::array<double, constants>& constant) {
        for (std::size_t c = 0; c < corners; ++c)
            node_[(i / lanes_ * corners_ + c) * lanes_ + i % lanes_] = row_offset(node[c]);
        set_constants(i, constant);
    }

    std::size_t bytes() const { return bytes_of(node_) + bytes_of(constant_); }

    Elements elements() const {
        return {groups_, node_.data(), constant_.empty() ? nullptr : constant_.front().data()};
    }

private:
    struct alignas(64) Line : std::array<double, 8> {};  // of a cache

    static std::int32_t row_offset(NodeIndex node) {
        return node * static_cast<std::int32_t>(sizeof(NodeVector));
    }

    template <std::size_t constants>
    void set_constants(std::size_t i, const std::array<double, constants>& constant) {
        for (std::size_t c = 0; c < constants; ++c) {
            const std::size_t at = (i / lanes_ * constants_ + c) * lanes_ + i % lanes_;
            constant_[at / Line{}.size()][at % Line{}.size()] = constant[c];
        }
    }

    std::size_t groups_ = 0, lanes_ = 1, corners_ = 0, constants_ = 0;
    std::vector<std::int32_t> node_;
    std::vector<Line> constant_;
};

}  // namespace twinchute::fullsim::unstructured
