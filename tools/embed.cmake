# SPDX-License-Identifier: MIT
# spume_embed(SOURCE FILE...): writes a source that defines spume::page_files() with the contents of the files, which the
# assembler reads: a megabyte of numbers in a list takes the compiler seconds.
function(spume_embed source)
  set(assembly)
  set(entries)
  set(declarations)
  set(number 0)
  foreach(file IN LISTS ARGN)
    get_filename_component(name ${file} NAME)
    get_filename_component(ending ${file} LAST_EXT)
    get_filename_component(path ${file} ABSOLUTE)
    set(type "text/plain")
    if(ending STREQUAL ".html")
      set(type "text/html")
    elseif(ending STREQUAL ".css")
      set(type "text/css")
    elseif(ending STREQUAL ".js")
      set(type "text/javascript")
    endif()
    string(APPEND assembly "asm(\".section .rodata\\nspume_page_${number}: .incbin \\\"${path}\\\"\\nspume_page_${number}_end:\\n.previous\");\n")
    string(APPEND declarations "extern const char begin_${number}[] asm(\"spume_page_${number}\"), end_${number}[] asm(\"spume_page_${number}_end\");\n")
    string(APPEND entries "      {\"${name}\", \"${type}\", {begin_${number}, std::size_t(end_${number} - begin_${number})}},\n")
    list(APPEND paths ${path})
    math(EXPR number "${number} + 1")
  endforeach()
  file(CONFIGURE OUTPUT ${source} @ONLY CONTENT "// Made by tools/embed.cmake.
#include \"spume/view/page_file.hpp\"

@assembly@
@declarations@
namespace spume {
std::span<const PageFile> page_files() {
  static const PageFile files[] = {
@entries@  };
  return files;
}
}  // namespace spume
")
  set_source_files_properties(${source} PROPERTIES OBJECT_DEPENDS "${paths}" SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON)
endfunction()
