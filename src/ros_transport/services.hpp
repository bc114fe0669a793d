// Serves and calls services by serialized requests and responses.
#pragma once

#include <ros/service_server.h>

#include <functional>
#include <optional>
#include <string>

#include "raw_message.hpp"

namespace robotteamsim::ros_transport {

struct ServiceType {
  std::string name;  // such as "std_srvs/Trigger"
  std::string md5sum;
};

class ServiceServer {
 public:
  // Called in a new thread for each request. The client receives the message of a std::exception as the error.
  using Handler = std::function<RawMessage(const RawMessage& request)>;

  ServiceServer(const std::string& service, const ServiceType& type, Handler handler);

 private:
  ros::ServiceServer server_;
};

// Returns the response; none if the service is not available in time [s, wall] or has failed.
std::optional<RawMessage> CallService(const std::string& service, const ServiceType& type, const RawMessage& request,
                                      double timeout_s);

}  // namespace robotteamsim::ros_transport
