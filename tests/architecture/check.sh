#!/usr/bin/env bash
# Checks the project rules that no compiler checks. Prints every breach as file:line: what, and fails
# when there is one.   Usage: check.sh TREE
set -euo pipefail
cd "$1"

breaches=0
report() {  # reads lines of findings
    local line
    while IFS= read -r line; do
        printf '%s\n' "$line"
        breaches=$((breaches + 1))
    done
}

modules=()
for module in lib rom fullsim compare study serve python; do
    [ ! -d "$module" ] || modules+=("$module")
done
if [ "${#modules[@]}" -eq 0 ] || [ ! -f main.cpp ]; then
    echo "$1: no modules or no main.cpp here, nothing was checked"
    exit 1
fi

sources=()
while IFS= read -r -d '' file; do sources+=("$file"); done < <(
    find "${modules[@]}" main.cpp -type f \( -name '*.cpp' -o -name '*.hpp' -o -name '*.h' -o -name '*.inl' \) -print0 | sort -z
)

# Include order: a file includes its own module or one further left. One pair of files includes SUNDIALS, one file cpp-httplib.
report < <(awk '
    BEGIN {
        rank["lib/math"] = 1; rank["lib/record"] = 2; rank["lib/models"] = 3; rank["lib/scene"] = 4
        rank["lib/solve"] = 5; rank["lib/cli"] = 6; rank["lib/exchange"] = 7; rank["rom"] = 7; rank["fullsim"] = 7
        rank["compare"] = 8; rank["study"] = 9; rank["serve"] = 10; rank["main.cpp"] = 11; rank["python"] = 11
    }
    function module_of(path,   part) {
        split(path, part, "/")
        return part[1] == "lib" ? "lib/" part[2] : part[1]
    }
    function say(what) { printf "%s:%d: %s\n", FILENAME, FNR, what }
    FNR == 1 {
        own = module_of(FILENAME)
        if (!(own in rank)) say("lies in no known module")
    }
    /^[ \t]*#[ \t]*include[ \t]*[<"]/ {
        match($0, /[<"][^>"]*/)
        quote = substr($0, RSTART, 1)
        target = substr($0, RSTART + 1, RLENGTH - 1)
        module = module_of(target)
        if (quote == "\"" && (!(module in rank) || target !~ /\//))
            say("\"" target "\" does not start with a module; quote files of other projects with <>")
        else if (quote == "<" && module in rank)
            say("<" target "> is a file of this tree: quote it")
        else if (module in rank && module != own) {
            if ((own == "compare" || own == "study" || own == "serve") && (module == "rom" || module == "fullsim") &&
                FILENAME !~ /^study\/size\//)
                say(own " sees only rows of Fidelity, not " target)
            else if (rank[module] >= rank[own])
                say(own " may not include " target)
        }
        if (target ~ /^(sundials|arkode|cvodes?|idas?|kinsol|nvector|sunmatrix|sunlinsol|sunnonlinsol)\// &&
            FILENAME !~ /^lib\/solve\/sundials(_lanes)?\.[ch]pp$/)
            say("<" target ">: only lib/solve/sundials* sees SUNDIALS")
        if (target == "httplib.h" && FILENAME != "serve/http_server.cpp")
            say("<" target ">: only serve/http_server.cpp sees cpp-httplib")
    }' "${sources[@]}")

# Libraries return or throw; only main ends the program.
report < <(awk '
    { line = $0; sub(/\/\/.*/, "", line); gsub(/"([^"\\]|\\.)*"/, "\"\"", line) }
    FILENAME != "main.cpp" && line ~ /(^|[^A-Za-z0-9_.>])(quick_|_)?(exit|Exit|abort)[ \t]*\(/ {
        printf "%s:%d: a library does not end the program\n", FILENAME, FNR
    }' "${sources[@]}")

# Eigen declares cross products in its core and defines them in Geometry, which in a batch another source may bring.
report < <(awk '
    FNR == 1 { has_geometry = 0 }
    /^#include <Eigen\/(Geometry|Dense)>/ { has_geometry = 1 }
    { line = $0; sub(/\/\/.*/, "", line) }
    FILENAME ~ /\.cpp$/ && FILENAME !~ /^tests\// && !has_geometry && line ~ /\.cross\(/ {
        printf "%s:%d: a cross product needs <Eigen/Geometry>\n", FILENAME, FNR
    }' "${sources[@]}")

report < <(awk 'END { if (NR >= 60) printf "main.cpp:%d: main.cpp stays under 60 lines\n", NR }' main.cpp)

# The installed program runs on any machine of its architecture. TWINCHUTE_ARCH is for measurements.
build_files=()
while IFS= read -r -d '' file; do build_files+=("$file"); done < <(
    find . \( -path ./build -o -path './build-*' -o -path ./.git \) -prune -o -type f \
        \( -name CMakeLists.txt -o -name '*.cmake' -o -name '*.cmake.in' -o -name 'CMakePresets.json' \
        -o -path ./bootstrap -o -path ./.ci/run \) -print0 | sort -z
)
if [ "${#build_files[@]}" -gt 0 ]; then
    report < <(awk '/-m(arch|cpu)=native/ {
        printf "%s:%d: nothing is built for the machine at hand alone\n", FILENAME, FNR
    }' "${build_files[@]}")
fi

if [ "$breaches" -gt 0 ]; then
    echo "$breaches breaches of the rules in docs/architecture.md"
    exit 1
fi
echo "${#sources[@]} sources keep the rules"
