#include <cstdio>

#include "tests/report/sample_document.hpp"
#include "veridyn/core/error.hpp"
#include "veridyn/core/files.hpp"
#include "veridyn/report/document/html.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: veridyn_sample_report FILE.html\n");
    return 2;
  }
  try {
    veridyn::write_file(argv[1], veridyn::report::to_html(veridyn::report::sample_document()));
  } catch (const veridyn::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
  return 0;
}
