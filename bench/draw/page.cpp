#include "bench/draw/page.h"

#include "bench/common/errors.h"
#include "bench/draw/page_parts.h"
#include "bench/pages/html.h"

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

std::size_t write_page(const std::string& path, const Json& pictures) {
  const std::string script = std::string("(() => {\n\"use strict\";\n") + kPageScript + "})();";
  return write_html(path, "winnow", kPageStyle,
                    std::string(kPageBody) + kThreeJsNotice +
                        script_element(three_js_file("three.min.js")) +
                        script_element(three_js_file("examples/js/controls/OrbitControls.js")) +
                        data_element("pictures", pictures) + script_element(script));
}

}  // namespace winnow::bench
