# Where ros-environment is missing, which sets the paths of all workspaces: the folders of this workspace's packages and of
# Debian's. No package of Debian 13 depends on it; `make` installs it.

_robotteamsim_paths=$(tr ';' ':' < "$CATKIN_ENV_HOOK_WORKSPACE/.catkin" 2> /dev/null)
for _robotteamsim_path in "${_robotteamsim_paths:-$CATKIN_ENV_HOOK_WORKSPACE/share}" /usr/share; do
  case ":$ROS_PACKAGE_PATH:" in
    *":$_robotteamsim_path:"*) ;;
    *) export ROS_PACKAGE_PATH="${ROS_PACKAGE_PATH:+$ROS_PACKAGE_PATH:}$_robotteamsim_path" ;;
  esac
done
unset _robotteamsim_paths _robotteamsim_path
# Where the output of a launch goes to a pipe or file, its lines appear when they are written, not at the end.
export ROSCONSOLE_STDOUT_LINE_BUFFERED="${ROSCONSOLE_STDOUT_LINE_BUFFERED:-1}"
export ROS_DISTRO="${ROS_DISTRO:-Debian}" ROS_VERSION="${ROS_VERSION:-1}" ROS_PYTHON_VERSION="${ROS_PYTHON_VERSION:-3}"
