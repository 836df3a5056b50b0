#!/usr/bin/env bash
# Shows that check.sh finds each thing it looks for: a small tree that keeps the rules passes, and
# one breach at a time fails with the right file and line.   Usage: check_can_fail.sh EMPTY_DIRECTORY
set -euo pipefail
check="$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)/check.sh"
work=$1
failures=0

good_tree() {
    rm -rf "$work"
    mkdir -p "$work"/lib/{math,record,models,scene,solve,cli} "$work"/{rom,fullsim,compare,study,serve,python,build}
    cd "$work"
    echo '#include <vector>' >lib/math/vec.hpp
    echo '#include "lib/math/vec.hpp"' >lib/record/record.hpp
    echo '#include "lib/math/vec.hpp"' >lib/models/model.hpp
    echo '#include "lib/record/record.hpp"' >lib/scene/scene.hpp
    echo '#include <arkode/arkode_erkstep.h>' >lib/solve/sundials.cpp
    printf '// exit(1) and "abort()" in words\nauto s = "exit(2)"; void on_exit_code(); int e = loop.exit();\n' >lib/cli/cli.cpp
    echo '#include "lib/solve/fidelity.hpp"' >rom/rom.cpp
    echo '#include "fullsim/mesh.hpp"' >fullsim/full.cpp
    echo '#include "lib/scene/scene.hpp"' >compare/compare.cpp
    echo '#include "compare/compare.hpp"' >study/study.cpp
    echo '#include "study/study.hpp"' >serve/serve.cpp
    echo '#include "serve/serve.hpp"' >python/module.cpp
    printf '#include "rom/rom.hpp"\n#include "compare/compare.hpp"\nint main() { return 0; }\n' >main.cpp
    echo 'project(x)' >CMakeLists.txt
    echo 'set(x -march=native)' >build/CMakeLists.txt # built files are not looked at
}

breach() {  # FILE LINE_OF_FILE TEXT_TO_APPEND
    good_tree
    printf '%s\n' "$3" >>"$1"
    local out
    if out=$("$check" "$work"); then
        echo "not found: $1: $3"
        failures=$((failures + 1))
    elif ! grep -qF "$1:$2: " <<<"$out"; then
        printf 'wrong place: %s:%s: %s\n%s\n' "$1" "$2" "$3" "$out"
        failures=$((failures + 1))
    fi
}

good_tree
"$check" "$work" || { echo "a tree that keeps the rules is refused"; exit 1; }

breach lib/math/vec.hpp 2 '#include "lib/record/record.hpp"'
breach lib/record/record.hpp 2 '#include "lib/models/model.hpp"'
breach lib/models/model.hpp 2 '#include "lib/scene/scene.hpp"'
breach lib/scene/scene.hpp 2 '  #  include "lib/solve/fidelity.hpp"'
breach lib/solve/sundials.cpp 2 '#include "lib/cli/cli.hpp"'
breach lib/cli/cli.cpp 3 '#include "rom/rom.hpp"'
breach rom/rom.cpp 2 '#include "fullsim/mesh.hpp"'
breach fullsim/full.cpp 2 '#include "rom/rom.hpp"'
breach fullsim/full.cpp 2 '#include "compare/compare.hpp"'
breach compare/compare.cpp 2 '#include "rom/rom.hpp"'
breach compare/compare.cpp 2 '#include "fullsim/full.hpp"'
breach compare/compare.cpp 2 '#include "study/study.hpp"'
breach study/study.cpp 2 '#include "rom/rom.hpp"'
breach study/study.cpp 2 '#include "python/module.hpp"'
breach study/study.cpp 2 '#include "serve/serve.hpp"'
breach serve/serve.cpp 2 '#include "rom/rom.hpp"'
breach serve/serve.cpp 2 '#include "python/module.hpp"'
breach main.cpp 4 '#include "python/module.hpp"'
breach python/module.cpp 2 '    std::exit(1);'
breach rom/rom.cpp 2 '    return a.cross(b);'
breach rom/rom.cpp 2 '#include "rom.hpp"'
breach rom/rom.cpp 2 '#include "other/rom.hpp"'
breach rom/rom.cpp 2 '#include "lib/other/rom.hpp"'
breach rom/rom.cpp 2 '#include "../fullsim/mesh.hpp"'
breach rom/rom.cpp 2 '#include <fullsim/mesh.hpp>'
breach lib/other.hpp 1 'int x;'
breach rom/rom.cpp 2 '#include <sundials/sundials_types.h>'
breach rom/rom.cpp 2 '#include <nvector/nvector_serial.h>'
breach main.cpp 4 '#include <cvode/cvode.h>'
breach serve/serve.cpp 2 '#include <httplib.h>'
breach lib/scene/scene.hpp 2 '    std::exit(1);'
breach rom/rom.cpp 2 'abort ();'
breach main.cpp 63 "$(printf '\n%.0s' {1..59}; echo '}')"
breach CMakeLists.txt 2 'add_compile_options(-march=native)'

good_tree
rm main.cpp
if "$check" "$work" >/dev/null; then
    echo "an incomplete tree passes"
    failures=$((failures + 1))
fi

[ "$failures" -eq 0 ] || exit 1
rm -rf "$work"
echo "every breach was found"
