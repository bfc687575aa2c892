// Debian's assimp checks itself with assertions that end the process; a file must not do that to
// us. This definition comes before the library's own and turns a failed assertion into an
// exception, which the importer reports as any other trouble with a file.
#include <stdexcept>
#include <string>

namespace Assimp {

__attribute__((visibility("default"))) void aiAssertViolation(const char* expression,
                                                              const char* /*file*/, int /*line*/) {
  throw std::runtime_error(std::string("the file breaks what the reader relies on (") + expression +
                           ")");
}

}  // namespace Assimp
