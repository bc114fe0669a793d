#include "services.hpp"

#include <ros/service.h>

#include "callbacks.hpp"
#include "node.hpp"

namespace robotteamsim::ros_transport {

ServiceServer::ServiceServer(const std::string& service, const ServiceType& type, Handler handler) {
  using Spec = ros::ServiceSpec<RawMessage, RawMessage>;
  const Spec::CallbackType call = [handler = std::move(handler)](RawMessage& request, RawMessage& response) {
    response = handler(request);
    // The client expects its change on the topics, so the response must not overtake those messages.
    WaitUntilSent();
    return true;
  };
  ros::AdvertiseServiceOptions options;
  options.service = service;
  options.datatype = type.name;
  options.md5sum = type.md5sum;
  options.req_datatype = type.name + "Request";
  options.res_datatype = type.name + "Response";
  options.helper = boost::make_shared<ros::ServiceCallbackHelperT<Spec>>(call);
  options.callback_queue = &Threaded();
  server_ = StartedNode().advertiseService(options);
}

std::optional<RawMessage> CallService(const std::string& service, const ServiceType& type, const RawMessage& request,
                                      double timeout_s) {
  if (!ros::service::waitForService(service, ros::Duration(timeout_s))) return std::nullopt;
  ros::ServiceClientOptions options(service, type.md5sum, /*persistent=*/false, ros::M_string());
  ros::ServiceClient client = StartedNode().serviceClient(options);
  RawMessage response;
  if (!client.call(request, response, type.md5sum)) return std::nullopt;
  return response;
}

}  // namespace robotteamsim::ros_transport
