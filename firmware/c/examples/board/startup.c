/* Start of a program on the emulated Cortex-M4F board (MPS2, AN386). Files and console are QEMU's, by
 * semihosting: newlib's `rdimon` has them. */

#include <stdint.h>
#include <stdlib.h>
#include <string.h>

extern uint32_t _data_start, _data_end, _data_load, _bss_start, _bss_end, _stack_top;

extern int main(void);
extern void initialise_monitor_handles(void);

void reset(void);
static void fault(void);

#ifdef INTERRUPTED
extern void tick(void);
extern int unmet(void);
#else
#define tick fault
#define unmet() 0
#endif

/* The vector table: initial stack pointer and the exceptions of the processor. */
struct vectors {
    uint32_t *stack;
    void (*exceptions[15])(void);
};

__attribute__((section(".vectors"), used)) static const struct vectors vectors = {
    &_stack_top,
    {reset, fault, fault, fault, fault, fault, NULL, NULL, NULL, NULL, fault, fault, NULL, fault,
     tick},
};

/* newlib calls these around constructors, of which C has none. */
void _init(void);
void _fini(void);

void _init(void) {
}

void _fini(void) {
}

/* Starts the system timer, where there is something for it to do. */
static void start_ticks(void) {
#ifdef INTERRUPTED
    volatile uint32_t *const systick = (volatile uint32_t *)0xE000E010U;
    systick[1] = 5003U; /* cycles from one interrupt to the next */
    systick[2] = 0U;
    systick[0] = 7U; /* processor clock, interrupt, on */
#endif
}

void reset(void) {
    /* The floating-point unit is off after reset (CPACR, coprocessors 10 and 11). */
    volatile uint32_t *const cpacr = (volatile uint32_t *)0xE000ED88U;
    *cpacr |= UINT32_C(0xF) << 20;
    __asm volatile("dsb\n isb" ::: "memory");
    (void)memcpy(&_data_start, &_data_load,
                 (size_t)((uintptr_t)&_data_end - (uintptr_t)&_data_start));
    (void)memset(&_bss_start, 0, (size_t)((uintptr_t)&_bss_end - (uintptr_t)&_bss_start));
    initialise_monitor_handles();
    start_ticks();
    const int status = main();
    exit((status == 0) ? unmet() : status);
}

static void fault(void) {
    _Exit(101);
}
