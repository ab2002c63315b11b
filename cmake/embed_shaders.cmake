# cmake -DOUTPUT=file.cpp -DROOT=src/gl/shaders -DFILES=a;b -P embed_shaders.cmake: shader files as a C++ array.
set(text "// Made from src/gl/shaders at build time.\n\n#include \"src/gl/shader_source.h\"\n\nnamespace tetravox::gl {\n\n")
string(APPEND text "std::span<const ShaderFile> embedded_shaders() {\n  static constexpr ShaderFile kFiles[] = {\n")
foreach(file IN LISTS FILES)
  file(READ "${ROOT}/${file}" content)
  string(APPEND text "{\"${file}\", R\"glsl(${content})glsl\"},\n")
endforeach()
string(APPEND text "};\n  return kFiles;\n}\n\n}  // namespace tetravox::gl\n")
file(WRITE "${OUTPUT}" "${text}")
