# cmake -DINPUT=page.html -DOUTPUT=page.cpp -P embed.cmake
# Bytes rather than a string literal: no delimiter, encoding or length of literals to think of.
file(READ ${INPUT} bytes HEX)
string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
string(REGEX REPLACE "(0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,0x..,)" "\\1\n" bytes "${bytes}")
file(
  WRITE ${OUTPUT}
  "// Generated from the front end's bundle.
#include \"veridyn/report/document/page.hpp\"

namespace veridyn::report::internal {

namespace {

constexpr unsigned char kPage[] = {
${bytes}};

}  // namespace

std::string_view page() { return {reinterpret_cast<const char*>(kPage), sizeof(kPage)}; }

bool page_has_figures() { return true; }

}  // namespace veridyn::report::internal
")
