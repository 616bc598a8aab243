# isorender in a container:  docker build -t isopoint .
#                            docker run --rm -v "$PWD:/data" isopoint volumes/stent.nrrd stent.png --isovalue 600
# ./run test docker executes these lines without Docker, in a Debian of debootstrap for each stage.
FROM debian:12 AS build
RUN apt-get update && apt-get install -y --no-install-recommends git
COPY . /isopoint
WORKDIR /isopoint
RUN git config --global --add safe.directory /isopoint && ./run packages

FROM debian:12
COPY --from=build /isopoint/build/packages/*.deb /packages/
RUN apt-get update && \
    apt-get install -y --no-install-recommends /packages/isopoint_*.deb /packages/isopoint-formats_*.deb && \
    rm -rf /packages /var/lib/apt/lists/*
WORKDIR /data
ENTRYPOINT ["isorender"]
