# Writes OUTPUT, a C++ file, with the bytes of FILES; run by the build. HEADER declares page_files() in the namespace of MODULE.

set(text "// Written by cmake/embed_files.cmake at build time.
#include \"${HEADER}\"

namespace twinchute::${MODULE} {
namespace {
")
set(rows "")
set(number 0)
foreach(file IN LISTS FILES)
  file(READ ${file} content)
  string(TOLOWER "${content}" lower)
  string(FIND "${lower}" "</script" at)  # ends a script of a page wherever it stands
  if(NOT at EQUAL -1 AND NOT file MATCHES "[.]html$")
    message(FATAL_ERROR "${file} holds a closing script tag and cannot stand in a page")
  endif()
  file(READ ${file} hex HEX)
  # The last line may name a source map, which no page has beside it.
  string(FIND "${content}" "//# sourceMappingURL" at REVERSE)
  if(NOT at EQUAL -1)
    math(EXPR at "2 * ${at}")
    string(SUBSTRING "${hex}" 0 ${at} hex)
  endif()
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${hex}")
  get_filename_component(name ${file} NAME)
  string(APPEND text "const unsigned char file_${number}[] = {${bytes}};\n")
  string(APPEND rows "        {\"${name}\", {reinterpret_cast<const char*>(file_${number}), sizeof file_${number}}},\n")
  math(EXPR number "${number} + 1")
endforeach()
string(APPEND text "
}  // namespace

std::span<const compare::PageFile> page_files() {
    static const compare::PageFile rows[] = {
${rows}    };
    return rows;
}

}  // namespace twinchute::${MODULE}
")
file(WRITE ${OUTPUT} "${text}")
