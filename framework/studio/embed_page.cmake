# SPDX-License-Identifier: Apache-2.0
# Writes a C++ source that holds files as they are.
#   cmake -DOUTPUT=FILE -DFOLDER=DIR -DFILES=FILE,FILE,... -P embed_page.cmake
string(REPLACE "," ";" files "${FILES}")
set(parts "")
set(table "")
set(count 0)
foreach(file ${files})
  file(RELATIVE_PATH name ${FOLDER} ${file})
  # A compiler's cache looks at the source alone: it must differ where a file does.
  file(SHA256 ${file} checksum)
  string(APPEND parts
    "// ${name} ${checksum}\n"
    "asm(\".section .rodata\\n.balign 16\\npage_file_${count}:\\n.incbin \\\"${file}\\\"\\n\"\n"
    "    \"page_file_${count}_end:\\n.byte 0\\n.text\\n\");\n"
    "extern \"C\" __attribute__((visibility(\"hidden\"))) const char page_file_${count}[],\n"
    "    page_file_${count}_end[];\n")
  string(APPEND table "    {\"/${name}\", page_file_${count}, page_file_${count}_end},\n")
  math(EXPR count "${count} + 1")
endforeach()
set(text "#include \"framework/studio/embedded_page.h\"\n\n${parts}\nnamespace lapwing {\n")
if(count GREATER 0)
  string(APPEND text "static const EmbeddedFile kFiles[] = {\n${table}};\n"
    "std::span<const EmbeddedFile> embedded_page() { return kFiles; }\n")
else()
  string(APPEND text "std::span<const EmbeddedFile> embedded_page() { return {}; }\n")
endif()
string(APPEND text "}  // namespace lapwing\n")
file(WRITE ${OUTPUT}.new "${text}")
file(RENAME ${OUTPUT}.new ${OUTPUT})
