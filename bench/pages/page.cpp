#include "bench/pages/page.h"

#include "bench/common/errors.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>

namespace winnow::bench {
namespace {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size()) {
    text.replace(at, what.size(), by);
  }
  return text;
}

std::string library(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    throw ArgumentError("the page needs " + path +
                        ", which is not there. On Debian:\n  apt-get install -y libjs-" +
                        (path.find("chart") != std::string::npos ? "chart.js" : "three"));
  }
  return replaced({std::istreambuf_iterator<char>(file), {}}, "</script", "<\\/script");
}

}  // namespace

void write_text(const std::string& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw ArgumentError("cannot write " + path + ": " + std::strerror(errno));
}

std::size_t write_page(const std::string& path, const char* page, const Json& data) {
  const std::string source = "<script src=\"/";
  const std::string place = "id=\"data\">";
  std::string text = page;
  for (std::size_t at = 0; (at = text.find(source, at)) != std::string::npos;) {
    const std::size_t name = at + source.size() - 1;
    const std::size_t end = text.find('"', name);
    const std::string script = "<script>\n" + library(text.substr(name, end - name));
    text.replace(at, end + 2 - at, script);
    at += script.size();
  }
  // A "<" in a text of the data could end the element.
  text.insert(text.find(place) + place.size(),
              replaced(data.dump(-1, ' ', true, Json::error_handler_t::replace), "<", "\\u003c"));
  write_text(path, text);
  return text.size();
}

}  // namespace winnow::bench
