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
  // Called from a thread of its own for each request. The message of a std::exception is what the client gets.
  using Handler = std::function<RawMessage(const RawMessage& request)>;

  ServiceServer(const std::string& service, const ServiceType& type, Handler handler);

 private:
  ros::ServiceServer server_;
};

// Returns the response; none: the service is not there in time [s, wall], or has failed.
std::optional<RawMessage> CallService(const std::string& service, const ServiceType& type, const RawMessage& request,
                                      double timeout_s);

}  // namespace robotteamsim::ros_transport
