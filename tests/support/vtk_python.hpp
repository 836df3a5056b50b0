// Python with VTK's modules, whose own reader says what is in the files that the program writes.
#pragma once

#include <string>
#include <vector>

#include "tests/support/process.hpp"

namespace twinchute::test {

/// The interpreter, or nothing where no Python has them. Debian's stands in /usr/bin, whatever other Python
/// comes first in the path.
inline const std::string& vtk_python() {
    static const std::string found = [] {
        for (const std::string python : {"python3", "/usr/bin/python3"}) {
            const std::vector<std::string> words{"/usr/bin/env", python, "-c", "import vtkmodules.vtkIOXML"};
            if (Process(words, "/").wait().code == 0) return python;
        }
        return std::string();
    }();
    return found;
}

/// Runs a script of the source tree.
inline Ended run_vtk_script(const std::string& script, const std::vector<std::string>& arguments,
                            const std::filesystem::path& directory) {
    std::vector<std::string> words{"/usr/bin/env", vtk_python(), TWINCHUTE_SOURCE_DIR "/" + script};
    words.insert(words.end(), arguments.begin(), arguments.end());
    return Process(words, directory).wait();
}

}  // namespace twinchute::test
