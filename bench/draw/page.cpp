#include "draw/page.h"

#include "draw/page_parts.h"
#include "tool/command.h"

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

void replace_all(std::string& text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size()) {
    text.replace(at, what.size(), by);
  }
}

// Nothing in a script element may look like its end.
std::string script(std::string text) {
  replace_all(text, "</script", "<\\/script");
  return "<script>\n" + text + "\n</script>\n";
}

std::string data(const Json& picture) {
  // Names of scenes come from files and may be any bytes.
  std::string text = picture.dump(-1, ' ', true, Json::error_handler_t::replace);
  replace_all(text, "<", "\\u003c");
  return "<script type=\"application/json\" id=\"picture\">\n" + text + "\n</script>\n";
}

}  // namespace

std::size_t write_page(const std::string& path, const Json& picture) {
  std::string page = "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n";
  page += std::string("<title>winnow</title>\n<style>\n") + kPageStyle + "</style>\n</head>\n";
  page += std::string("<body>\n") + kPageBody + kThreeJsNotice;
  page += script(three_js_file("three.min.js"));
  page += script(three_js_file("examples/js/controls/OrbitControls.js"));
  page += data(picture);
  page += script(std::string("(() => {\n\"use strict\";\n") + kPageScript + "})();");
  page += "</body>\n</html>\n";
  std::ofstream file(path, std::ios::binary);
  file << page;
  file.close();
  if (!file) throw ArgumentError("--out: cannot write " + path + ": " + std::strerror(errno));
  return page.size();
}

}  // namespace winnow::bench
