#include "bench/draw/page.h"

#include "bench/common/errors.h"
#include "bench/draw/page_parts.h"
#include "bench/pages/html.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

namespace winnow::bench {
namespace {

std::string three_js_file(const std::string& name) {
  const std::string path = std::string(kThreeJsFolder) + "/" + name;
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw ArgumentError("drawing needs three.js, and " + path +
                        " is not there. On Debian:\n  apt-get install -y libjs-three");
  }
  return {std::istreambuf_iterator<char>(file), {}};
}

}  // namespace

std::size_t write_page(const std::string& path, const Json& picture) {
  std::string page = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  page += std::string("<title>winnow</title>\n<style>\n") + kPageStyle + "</style>\n</head>\n";
  page += std::string("<body>\n") + kPageBody + kThreeJsNotice;
  page += script_element(three_js_file("three.min.js"));
  page += script_element(three_js_file("examples/js/controls/OrbitControls.js"));
  page += data_element("picture", picture);
  page += script_element(std::string("(() => {\n\"use strict\";\n") + kPageScript + "})();");
  page += "</body>\n</html>\n";
  std::ofstream file(path, std::ios::binary);
  file << page;
  file.close();
  if (!file) throw ArgumentError("--out: cannot write " + path + ": " + std::strerror(errno));
  return page.size();
}

}  // namespace winnow::bench
