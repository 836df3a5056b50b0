#!/usr/bin/env bash
# clang-tidy as .clang-tidy says, on what has changed or on everything.
# Usage: tidy.sh BUILD all          every source of the tree
#        tidy.sh BUILD changed      those that differ from the branch this one grew from, and those that
#                                   include a changed header; with TIDY_SECONDS set, those that fit into it
# BUILD is a configured build directory with compile_commands.json. A third argument leaves out what does not
# lie below that folder.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=$1
which=$2
folder=${3:-}

tidy=""
for name in clang-tidy clang-tidy-14; do
    if command -v "$name" >/dev/null 2>&1; then
        tidy=$name
        break
    fi
done
if [ -z "$tidy" ]; then
    echo "tidy.sh: clang-tidy was not found (Debian: apt-get install clang-tidy)" >&2
    exit 1
fi
if [ ! -f "$build/compile_commands.json" ]; then
    echo "tidy.sh: no compile_commands.json in $build, configure it first" >&2
    exit 1
fi

# Sources that this build compiles, alone or in batches, which include them: those of a target that is not
# built here cannot be looked at. clang-tidy takes the flags of a batched source from its neighbours.
sources() {
    local files
    files=$(sed -n 's/^ *"file": "\(.*\)",\{0,1\}$/\1/p' "$build/compile_commands.json")
    {
        echo "$files"
        { grep '/Unity/unity_[0-9]*_cxx\.cxx$' <<<"$files" || true; } |
            xargs -r -d '\n' sed -n 's/^#include "\(.*\)"$/\1/p'
    } | sed -n "s|^$PWD/||p" | grep -E '^(lib|rom|fullsim|compare|study|serve|python|tests|main)' |
        { grep "^$folder" || true; } | sort -u
}

# The commit to compare with: where this branch left the main line; on the main line itself, the one before.
base() {
    local head ref fork
    head=$(git rev-parse HEAD 2>/dev/null) || return 1
    for ref in "${TIDY_BASE:-}" origin/HEAD origin/main main; do
        [ -n "$ref" ] || continue
        fork=$(git merge-base HEAD "$ref" 2>/dev/null) || continue
        [ "$fork" = "$head" ] || { echo "$fork"; return; }
    done
    git rev-parse --verify --quiet HEAD~1
}

# The sources among stdin's lines, and those that include a header among them, through other headers as well.
touched() {
    local changed header more
    changed=$(cat)
    while :; do
        more=$(
            while IFS= read -r header; do
                grep -rlF --include='*.hpp' "#include \"$header\"" lib rom fullsim compare study serve python tests || true
            done < <(grep -E '\.hpp$' <<<"$changed" || true)
        )
        more=$(printf '%s\n' "$changed" "$more" | sed '/^$/d' | sort -u)
        [ "$more" != "$changed" ] || break
        changed=$more
    done
    while IFS= read -r header; do
        grep -rlF --include='*.cpp' "#include \"$header\"" lib rom fullsim compare study serve python tests main.cpp || true
    done < <(grep -E '\.hpp$' <<<"$changed" || true)
    grep -E '\.cpp$' <<<"$changed" || true
}

all=$(sources)
list=$all
note="all"
if [ "$which" = changed ]; then
    if commit=$(base); then
        # What was changed itself comes first, then what only includes it.
        direct=$({ git diff --name-only "$commit" && git ls-files --others --exclude-standard; } | sort -u)
        note="changed since ${commit:0:12}"
        indirect=$(touched <<<"$direct" | sort -u)
        list=$(
            {
                grep -xFf <(echo "$direct") <<<"$all" || true
                grep -xFf <(echo "$indirect") <<<"$all" || true
            } | awk '!seen[$0]++'
        )
    else
        note="all, there is no commit to compare with"
    fi
fi
if [ -z "$list" ]; then
    echo "clang-tidy: no sources ($note)"
    exit 0
fi

end=$(($(date +%s) + ${TIDY_SECONDS:-86400}))
log=$(mktemp -d)
trap 'rm -rf "$log"' EXIT
# What GCC alone schedules and searches by, clang would take for a mistake.
sed 's/ -fschedule-insns -fsched-pressure//g; s/ --param=[a-z-]*=[0-9]*//g' "$build/compile_commands.json" >"$log/compile_commands.json"
export tidy log end
count=$(wc -l <<<"$list")
cores=$(nproc 2>/dev/null || echo 2)
code=0
# shellcheck disable=SC2016 # expanded by the inner shell
xargs -P "$cores" -I{} bash -c '
    if [ "$(date +%s)" -ge "$end" ]; then
        echo "{}" >>"$log/left"
    elif ! out=$("$tidy" --quiet -p "$log" --extra-arg=-Wno-unknown-warning-option "{}" 2>/dev/null); then
        printf "%s\n" "$out"
        exit 1
    fi' <<<"$list" || code=1
left=0
[ ! -f "$log/left" ] || left=$(wc -l <"$log/left")
if [ "$code" -ne 0 ]; then
    echo "clang-tidy: findings above ($note)" >&2
    exit 1
fi
echo "clang-tidy: nothing found in $((count - left)) of $count sources ($note)"
