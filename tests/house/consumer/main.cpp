// Reads the demo scene out of the installed data through the installed library.
#include <cstdio>
#include <exception>

#include "lib/scene/read_scene.hpp"

int main() try {
    const twinchute::Scene scene = twinchute::read_scene(DATA "/scenes/c9-inflation.toml");
    std::printf("%s: %g kg\n", scene.name.c_str(), scene.payload.mass);
    return scene.payload.mass > 0.0 ? 0 : 1;
} catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
