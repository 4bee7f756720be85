// Answers ray queries of the benches with Embree 3, for comparison.
//
// Usage: embree FILE, where FILE holds the mesh and the rays as mod.rs writes them. It prints the seconds that each
// build took, then for each line "QUERY SET THREADS" on standard input one line "SECONDS HITS".
// QUERY is closest, occluded, closest8 or closest16, with "-fast" appended for the scene without the robust flag.
#include <embree3/rtcore.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <string>
#include <thread>
#include <vector>

namespace {

using Clock = std::chrono::steady_clock;

struct Ray {
    float origin[3], t_max, direction[3], time;
};

struct Input {
    std::vector<float> positions;
    std::vector<uint32_t> triangles;
    std::vector<std::vector<Ray>> sets;
};

template <typename T>
std::vector<T> read_list(FILE* file, size_t per_item) {
    uint64_t count = 0;
    if (fread(&count, sizeof count, 1, file) != 1) exit(2);
    std::vector<T> list(count * per_item);
    if (fread(list.data(), sizeof(T), list.size(), file) != list.size()) exit(2);
    return list;
}

Input read_input(const char* path) {
    FILE* file = fopen(path, "rb");
    if (!file) exit(2);
    Input input;
    input.positions = read_list<float>(file, 3);
    input.triangles = read_list<uint32_t>(file, 3);
    uint64_t sets = 0;
    if (fread(&sets, sizeof sets, 1, file) != 1) exit(2);
    for (uint64_t i = 0; i < sets; ++i) input.sets.push_back(read_list<Ray>(file, 1));
    fclose(file);
    return input;
}

RTCScene build(RTCDevice device, const Input& input, RTCSceneFlags flags) {
    auto start = Clock::now();
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, flags);
    RTCGeometry mesh = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    size_t vertices = input.positions.size() / 3, triangles = input.triangles.size() / 3;
    void* v = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12, vertices);
    void* t = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, triangles);
    std::copy(input.positions.begin(), input.positions.end(), static_cast<float*>(v));
    std::copy(input.triangles.begin(), input.triangles.end(), static_cast<uint32_t*>(t));
    rtcCommitGeometry(mesh);
    rtcAttachGeometry(scene, mesh);
    rtcReleaseGeometry(mesh);
    rtcCommitScene(scene);
    printf("%.6f\n", std::chrono::duration<double>(Clock::now() - start).count());
    fflush(stdout);
    return scene;
}

RTCRay single(const Ray& r) {
    RTCRay ray = {};
    ray.org_x = r.origin[0], ray.org_y = r.origin[1], ray.org_z = r.origin[2];
    ray.dir_x = r.direction[0], ray.dir_y = r.direction[1], ray.dir_z = r.direction[2];
    ray.tfar = r.t_max, ray.mask = -1u;
    return ray;
}

size_t closest(RTCScene scene, const Ray* rays, size_t count) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    size_t hits = 0;
    for (size_t i = 0; i < count; ++i) {
        RTCRayHit query = {};
        query.ray = single(rays[i]);
        query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
        rtcIntersect1(scene, &context, &query);
        hits += query.hit.geomID != RTC_INVALID_GEOMETRY_ID;
    }
    return hits;
}

size_t occluded(RTCScene scene, const Ray* rays, size_t count) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    size_t hits = 0;
    for (size_t i = 0; i < count; ++i) {
        RTCRay ray = single(rays[i]);
        rtcOccluded1(scene, &context, &ray);
        hits += ray.tfar < 0;
    }
    return hits;
}

void trace(RTCScene scene, const int* valid, RTCIntersectContext* context, RTCRayHit8* query) {
    rtcIntersect8(valid, scene, context, query);
}

void trace(RTCScene scene, const int* valid, RTCIntersectContext* context, RTCRayHit16* query) {
    rtcIntersect16(valid, scene, context, query);
}

template <typename Packet, size_t WIDTH>
size_t packets(RTCScene scene, const Ray* rays, size_t count) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    size_t hits = 0;
    for (size_t start = 0; start < count; start += WIDTH) {
        Packet query = {};
        alignas(64) int valid[WIDTH] = {};
        for (size_t lane = 0; lane < WIDTH && start + lane < count; ++lane) {
            const Ray& r = rays[start + lane];
            valid[lane] = -1;
            query.ray.org_x[lane] = r.origin[0], query.ray.org_y[lane] = r.origin[1];
            query.ray.org_z[lane] = r.origin[2], query.ray.dir_x[lane] = r.direction[0];
            query.ray.dir_y[lane] = r.direction[1], query.ray.dir_z[lane] = r.direction[2];
            query.ray.tfar[lane] = r.t_max, query.ray.mask[lane] = -1u;
            query.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
        }
        trace(scene, valid, &context, &query);
        for (size_t lane = 0; lane < WIDTH; ++lane) {
            hits += valid[lane] && query.hit.geomID[lane] != RTC_INVALID_GEOMETRY_ID;
        }
    }
    return hits;
}

size_t answer(const std::string& query, RTCScene scene, const Ray* rays, size_t count) {
    if (query == "closest") return closest(scene, rays, count);
    if (query == "occluded") return occluded(scene, rays, count);
    if (query == "closest8") return packets<RTCRayHit8, 8>(scene, rays, count);
    if (query == "closest16") return packets<RTCRayHit16, 16>(scene, rays, count);
    exit(2);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc != 2) return 2;
    Input input = read_input(argv[1]);
    RTCDevice device = rtcNewDevice(nullptr);
    RTCScene robust = build(device, input, RTC_SCENE_FLAG_ROBUST);
    RTCScene fast = build(device, input, RTC_SCENE_FLAG_NONE);
    std::string query;
    size_t set = 0, threads = 0;
    while (std::cin >> query >> set >> threads) {
        RTCScene scene = robust;
        if (auto end = query.find("-fast"); end != std::string::npos) {
            scene = fast;
            query.resize(end);
        }
        const std::vector<Ray>& rays = input.sets.at(set);
        constexpr size_t CHUNK = 4096;
        std::atomic<size_t> next(0), hits(0);
        auto work = [&] {
            for (size_t i; (i = next.fetch_add(CHUNK)) < rays.size();) {
                hits += answer(query, scene, rays.data() + i, std::min(CHUNK, rays.size() - i));
            }
        };
        auto start = Clock::now();
        std::clock_t busy = std::clock();
        std::vector<std::thread> pool;
        for (size_t i = 1; i < threads; ++i) pool.emplace_back(work);
        work();
        for (auto& thread : pool) thread.join();
        double seconds = std::chrono::duration<double>(Clock::now() - start).count();
        // Of one thread its processor time: other programs may be running.
        if (threads == 1) seconds = double(std::clock() - busy) / CLOCKS_PER_SEC;
        printf("%.9f %zu\n", seconds, hits.load());
        fflush(stdout);
    }
}
