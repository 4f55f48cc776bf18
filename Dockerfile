# The reproduction on a CPU, without a screen:
#   docker build -t move . && docker run --rm move make test && docker run --rm move make figures PROFILE=smoke
FROM python:3.11-slim-trixie AS system
RUN apt-get update \
    && apt-get install --yes --no-install-recommends git libegl1 libgl1-mesa-dri libopengl0 make \
    && rm -rf /var/lib/apt/lists/*
ENV TORCH_INDEX=https://download.pytorch.org/whl/cpu

FROM system
WORKDIR /move
COPY . .
RUN git config --global --add safe.directory /move && make setup
CMD ["make", "figures", "PROFILE=smoke"]
