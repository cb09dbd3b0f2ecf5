#include "core/shared_object.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace lamella {
namespace {

using ::testing::HasSubstr;

TEST(SharedObject, GivesAFunctionThatCanBeCalled) {
  auto* const cosine = find_function_of<double(double)>("libm.so.6", "cos");
  EXPECT_EQ(cosine(0.0), 1.0);
}

TEST(SharedObject, NamesWhatIsMissing) {
  try {
    (void)find_function("liblamella_of_nowhere.so", "f");
    FAIL() << "was loaded";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("liblamella_of_nowhere.so"));
    EXPECT_EQ(error.where(), "liblamella_of_nowhere.so");
    EXPECT_THAT(error.hint(), HasSubstr("install"));
  }
  EXPECT_THROW((void)find_function("libm.so.6", "lamella_has_none"), InputError);
}

}  // namespace
}  // namespace lamella
