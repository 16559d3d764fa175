// What Boost would throw ends the program where it is built without exceptions: only wrong use of
// its numbers would.

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
