/* The kernel's own simulation of interrupts, made a module: it is meant to be built in, and what it calls is then at hand. */
#include <linux/irq.h>
#include <linux/irqdesc.h>
#include <linux/module.h>

static inline struct irq_desc *descriptor_of(unsigned int irq)
{
	struct irq_data *data = irq_get_irq_data(irq); /* exported to modules, as irq_to_desc is not */

	return data ? irq_data_to_desc(data) : NULL;
}
#define irq_to_desc(irq) descriptor_of(irq)
#include "irq_sim.c"

MODULE_LICENSE("GPL");
MODULE_DESCRIPTION("Simulated interrupts");
