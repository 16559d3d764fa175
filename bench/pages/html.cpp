#include "bench/pages/html.h"

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

}  // namespace winnow::bench
