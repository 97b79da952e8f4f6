#include "host_sim/watch/watch_page.hpp"

#include <stdexcept>

#include "firmware/description/version.hpp"
#include "host_sim/report/embedded_files.hpp"

namespace host_sim::watch {
namespace {

void put(std::string& page, std::string_view mark, std::string_view text) {
  const std::size_t place = page.find(mark);
  if (place == std::string::npos) throw std::logic_error("the page of rigtwin watch has no " + std::string(mark));
  page.replace(place, mark.size(), text);
}

}  // namespace

std::string watch_page(std::string_view nonce) {
  std::string page(embedded_file("watch.html"));
  put(page, "@style@", embedded_file("watch.css"));
  put(page, "@script@", embedded_file("watch.js"));
  put(page, "@style_nonce@", nonce);
  put(page, "@script_nonce@", nonce);
  put(page, "@version@", firmware::version);
  return page;
}

std::string watch_page_policy(std::string_view nonce) {
  const std::string own = "'nonce-" + std::string(nonce) + "'";
  return "default-src 'none'; script-src " + own + "; style-src " + own +
         "; connect-src 'self'; img-src data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
}

}  // namespace host_sim::watch
