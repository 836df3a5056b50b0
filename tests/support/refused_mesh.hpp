// A mesh from outside that has to be refused.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "fullsim/mesh/import_mesh.hpp"
#include "lib/scene/scene_error.hpp"

namespace twinchute::test {

/// At this line of the file, in these words.
inline void expect_mesh_refused(const std::string& text, int line, const std::vector<std::string>& words,
                                const Scene& scene) {
    try {
        fullsim::import_mesh(fullsim::read_gmsh(text, "own.msh"), scene);
        ADD_FAILURE() << "accepted, wanted: " << words.front();
    } catch (const SceneError& error) {
        for (const std::string& word : words)
            EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
        EXPECT_EQ(error.place().file, "own.msh");
        EXPECT_EQ(error.place().line, line) << error.what();
    }
}

}  // namespace twinchute::test
