// Any bytes as a mesh of Gmsh: a parachute whose lengths and masses are numbers, in a start, too, or a
// SceneError with a place.
#include "fullsim/mesh/gmsh_write.hpp"
#include "fullsim/mesh/line_stretch_configuration.hpp"
#include "lib/scene/scene_error.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/support/c9_scene.hpp"

#include <cmath>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace twinchute;
    using namespace twinchute::fullsim;
    static const Scene scene = test::c9_scene();
    try {
        const GmshMesh file = read_gmsh(fuzz::text_of(data, size), "own.msh");
        const ImportedMesh got = import_mesh(file, scene);
        fuzz::require(std::isfinite(got.mesh.parachute_mass()), "masses are numbers");
        for (const Cable& c : got.mesh.cables)
            fuzz::require(c.rest_length > 0.0 && c.strands > 0.0, "a cable has length and strands");
        const GmshMesh again = read_gmsh(gmsh_text(got.mesh, GmshVersion::v4_1, "again"), "again.msh");
        fuzz::require(again.nodes.size() == got.mesh.position.size(), "what is written is read");
        line_stretch_configuration(got, scene, Vec3::UnitZ(), 1.0, 0.0, false);
    } catch (const SceneError& error) {
        // A mesh that cannot be folded is refused by the scene's key.
        fuzz::require(!error.key().empty() || (!error.place().file.empty() && error.place().line > 0),
                      "an error has a place or a key");
    }
    return 0;
}
