# SPDX-License-Identifier: Apache-2.0
# Writes a C++ source with the report's style and scripts as raw strings.
#   cmake -DOUTPUT=FILE -DSTYLE=FILE -DSCRIPTS=FILE,FILE,... -P embed_assets.cmake
function(append_string name)
  file(APPEND ${OUTPUT}.new "const std::string_view ${name} =\n")
  foreach(file ${ARGN})
    file(READ ${file} text)
    string(FIND "${text}" ")asset\"" clash)
    if(NOT clash EQUAL -1)
      message(FATAL_ERROR "${file} holds the delimiter of its raw string")
    endif()
    file(APPEND ${OUTPUT}.new "    R\"asset(${text})asset\"\n")
  endforeach()
  file(APPEND ${OUTPUT}.new "    ;\n")
endfunction()

string(REPLACE "," ";" scripts "${SCRIPTS}")
file(WRITE ${OUTPUT}.new "#include \"framework/export/report_assets.h\"\n\nnamespace lapwing {\n")
append_string(kReportStyle ${STYLE})
append_string(kReportScript ${scripts})
file(APPEND ${OUTPUT}.new "}  // namespace lapwing\n")
file(RENAME ${OUTPUT}.new ${OUTPUT})
