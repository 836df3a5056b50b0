// Scripts of the source tree that need a Python package beyond its own library.
#pragma once

#include <string>
#include <vector>

#include "tests/support/process.hpp"

namespace twinchute::test {

/// Runs a script with the first Python that has what it needs: it ends with 77 where that is missing.
/// Debian's stands in /usr/bin, whatever other Python comes first in the path. 77 or 127: none has.
inline Ended run_script(const std::string& script, const std::vector<std::string>& arguments,
                        const std::filesystem::path& directory) {
    Ended ended;
    for (const std::string python : {"python3", "/usr/bin/python3"}) {
        std::vector<std::string> words{"/usr/bin/env", python, TWINCHUTE_SOURCE_DIR "/" + script};
        words.insert(words.end(), arguments.begin(), arguments.end());
        ended = Process(words, directory).wait();
        if (ended.code != 77 && ended.code != 127) break;
    }
    return ended;
}

inline bool lacks_python(const Ended& ended) {
    return ended.code == 77 || ended.code == 127;
}

}  // namespace twinchute::test
