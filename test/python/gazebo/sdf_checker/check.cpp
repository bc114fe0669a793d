// Checks files as `ign sdf --check` does, but treats warnings and unknown elements as errors.
#include <iostream>
#include <sdf/sdf.hh>

namespace {

bool IsValid(const char* path) {
  sdf::ParserConfig strict = sdf::ParserConfig::GlobalConfig();
  strict.SetWarningsPolicy(sdf::EnforcementPolicy::ERR);
  strict.SetUnrecognizedElementsPolicy(sdf::EnforcementPolicy::ERR);
  strict.SetDeprecatedElementsPolicy(sdf::EnforcementPolicy::ERR);
  sdf::Root root;
  sdf::Errors errors = root.Load(path, strict);
  if (errors.empty()) sdf::checkJointParentChildNames(&root, errors);
  for (const sdf::Error& error : errors) std::cerr << path << ": " << error << "\n";
  return errors.empty() && sdf::checkCanonicalLinkNames(&root) && sdf::checkFrameAttachedToNames(&root) &&
         sdf::checkFrameAttachedToGraph(&root) && sdf::checkPoseRelativeToGraph(&root) &&
         sdf::recursiveSiblingUniqueNames(root.Element());
}

}  // namespace

int main(int count, char** paths) {
  bool valid = count > 1;
  for (int i = 1; i < count; ++i) valid = IsValid(paths[i]) && valid;
  return valid ? 0 : 1;
}
