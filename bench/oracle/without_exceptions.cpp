// Boost calls these functions in a build without exceptions. Only wrong use of its numbers leads
// here, so they end the program.

#include <boost/throw_exception.hpp>

#ifdef BOOST_NO_EXCEPTIONS

#include <exception>

namespace boost {

void throw_exception(const std::exception& /*thrown*/) {
  std::terminate();
}
void throw_exception(const std::exception& /*thrown*/, const source_location& /*from*/) {
  std::terminate();
}

}  // namespace boost

#endif
