# Writes OUTPUT, a source file that holds the bytes of FILES for BuiltInFile() of page_server.h.
set(entries "")
foreach(file IN LISTS FILES)
  get_filename_component(name ${file} NAME)
  file(READ ${file} bytes HEX)
  string(LENGTH "${bytes}" digits)
  math(EXPR size "${digits} / 2")
  # String literals of 32 bytes: an array of characters of this size would take the compiler seconds.
  string(REGEX REPLACE "(................................................................)" "\\1\"\n\"" lines "${bytes}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "\\\\x\\1" lines "${lines}")
  string(APPEND entries "      {\"${name}\",\n       std::string(\"${lines}\", ${size})},\n")
endforeach()
file(WRITE ${OUTPUT} "#include \"tools/operator/page_server.h\"

#include <map>
#include <string>

namespace coach {

const std::string* BuiltInFile(const std::string& name) {
  static const std::map<std::string, std::string> files{
${entries}  };
  const auto file = files.find(name);
  return file == files.end() ? nullptr : &file->second;
}

}  // namespace coach
")
