# SPDX-License-Identifier: MIT
# In a bare Debian, from the static library alone (recipes.sh): a stranger's project finds it by find_package() and by
# pkg-config, in C++ and in C, forgets OpenCL's headers and its driver, and asks for versions that are not there.
walk=library
apt update
apt install g++ cmake make pkg-config
tar -C /usr/local -xzf /artefacts/gnomon-static.tar.gz
consumer=/artefacts/consumer
fails 1 "OpenCL's headers" cmake -S $consumer -B nothing
did "find_package(gnomon) without OpenCL's headers: $said"
apt install opencl-c-headers ocl-icd-opencl-dev

cmake -S $consumer -B build -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build build >build.log 2>&1 || { tail -20 build.log; exit 1; }
fails 1 "no OpenCL device" as_stranger build/example
did "example.cpp without a driver: $said"
apt install pocl-opencl-icd
[ "$(as_stranger build/example | head -3)" = "$(printf 'point 0 is in shadow\npoint 1 is in shadow\npoint 2 is in the light')" ]
answer="2048 of 4096 points are in the light"
[ "$(as_stranger build/embedding_in_c)" = "$answer" ]
did "find_package(gnomon), static, with a home that cannot be written: example.cpp, and embedding.c: $answer"
gcc -std=c11 $consumer/embedding.c -o by_pkg_config $(pkg-config --static --cflags --libs gnomon) -lOpenCL
[ "$(./by_pkg_config)" = "$answer" ]
did "pkg-config --static gnomon: the same"

for version in 0.2 9; do
    cp -r $consumer asks_for_another
    sed -i "s/find_package(gnomon [0-9.]* REQUIRED)/find_package(gnomon $version REQUIRED)/" asks_for_another/CMakeLists.txt
    fails 1 "requested version \"$version\"" cmake -S asks_for_another -B wrong
    fails 1 "version: " cmake -S asks_for_another -B wrong
    did "find_package(gnomon $version): none is compatible; found was $said"
    rm -r asks_for_another wrong
done
