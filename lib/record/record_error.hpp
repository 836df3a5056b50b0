// The one exception for a record that cannot be read.
#pragma once

#include <stdexcept>
#include <string>

namespace twinchute {

/// Where in a record something stands; line and column (in bytes) count from 1, 0 means unknown.
struct RecordPlace {
    std::string file;
    int line = 0;
    int column = 0;
};

/// what() reads "file:line:column: problem (why), suggestion".
class RecordError : public std::runtime_error {
public:
    RecordError(RecordPlace place, const std::string& problem, const std::string& why,
                const std::string& suggestion);

    const RecordPlace& place() const { return place_; }

private:
    RecordPlace place_;
};

}  // namespace twinchute
