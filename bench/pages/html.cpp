#include "bench/pages/html.h"

#include "bench/common/errors.h"

#include <cerrno>
#include <cstring>
#include <fstream>

namespace winnow::bench {

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size()) {
    text.replace(at, what.size(), by);
  }
  return text;
}

std::string escaped(const std::string& text) {
  return replaced(replaced(replaced(text, "&", "&amp;"), "<", "&lt;"), ">", "&gt;");
}

std::string script_element(const std::string& text) {
  return "<script>\n" + replaced(text, "</script", "<\\/script") + "\n</script>\n";
}

std::string data_element(const std::string& id, const Json& value) {
  const std::string text = value.dump(-1, ' ', true, Json::error_handler_t::replace);
  return "<script type=\"application/json\" id=\"" + id + "\">\n" + replaced(text, "<", "\\u003c") +
         "\n</script>\n";
}

std::size_t write_html(const std::string& path, const std::string& title, const std::string& style,
                       const std::string& body) {
  const std::string page =
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n<meta "
      "name=\"viewport\" content=\"width=device-width\">\n<title>" +
      escaped(title) + "</title>\n<style>\n" + style + "</style>\n</head>\n<body>\n" + body +
      "</body>\n</html>\n";
  std::ofstream file(path, std::ios::binary);
  file << page;
  file.close();
  if (!file) throw ArgumentError("cannot write " + path + ": " + std::strerror(errno));
  return page.size();
}

}  // namespace winnow::bench
